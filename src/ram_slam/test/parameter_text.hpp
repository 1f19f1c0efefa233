// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "ram_parameters/parameter_reader.hpp"

namespace ram_slam {

/// Parameters read from a text in YAML by one of the functions that read them.
template <typename P>
P readText(P (*read)(ram_parameters::ParameterReader&), const std::string& yaml) {
  ram_parameters::ParameterReader reader(YAML::Load(yaml), "test");
  return read(reader);
}

/// Why the text is refused; empty if it is not.
template <typename P>
std::string refusalOfText(P (*read)(ram_parameters::ParameterReader&), const std::string& yaml) {
  try {
    readText(read, yaml);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// Every value of a shipped file is the default of its parameter.
template <typename P>
void expectDefaultsIn(const std::string& file, P (*read)(ram_parameters::ParameterReader&)) {
  const std::string path = std::string(CONFIG_FOLDER) + "/" + file;
  ram_parameters::ParameterReader reader(ram_parameters::readYamlFile(path), path);
  const auto shipped = P::table().rows(read(reader));
  const auto defaults = P::table().rows();
  ASSERT_EQ(shipped.size(), defaults.size());
  for (std::size_t i = 0; i < shipped.size(); ++i)
    EXPECT_EQ(shipped[i].value, defaults[i].value) << shipped[i].key;
}

}  // namespace ram_slam
