// SPDX-License-Identifier: BSD-3-Clause
// Writes config/*.yaml and docs/parameters.md from the parameter tables in the code, or compares
// them with what is there.
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "ram_parameters/parameter_file.hpp"
#include "ram_slam/parameter_files.hpp"
#include "ramscout_feature_detector/parameter_files.hpp"
#include "ramscout_kinematics/parameter_files.hpp"
#include "ramscout_sim/parameter_files.hpp"

namespace {

/// Path below the root of the repository, and text.
using Document = std::pair<std::string, std::string>;

std::vector<ram_parameters::ParameterFile> allFiles() {
  std::vector<ram_parameters::ParameterFile> files;
  const auto add = [&files](const std::vector<ram_parameters::ParameterFile>& more) {
    files.insert(files.end(), more.begin(), more.end());
  };
  add(ram_slam::parameterFiles());
  add(ramscout_feature_detector::parameterFiles());
  add(ramscout_kinematics::parameterFiles());
  add(ramscout_sim::parameterFiles());
  return files;
}

std::vector<Document> documents() {
  std::vector<Document> documents;
  std::string reference =
      "# Parameters\n\n"
      "Every parameter of every node, made from the tables in the code by `make parameters`. Those "
      "marked *(expert)* are not in the shipped files; a node accepts them all the same.\n";
  for (const auto& file : allFiles()) {
    documents.emplace_back("config/" + file.name, ram_parameters::toYaml(file));
    reference += '\n' + ram_parameters::toMarkdown(file);
  }
  documents.emplace_back("docs/parameters.md", reference);
  return documents;
}

std::string textOf(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// \returns whether the file is as it should be
bool check(const std::string& path, const std::string& text) {
  if (textOf(path) == text) return true;
  std::cerr << path << " differs from the tables in the code: run `make parameters`\n";
  return false;
}

bool write(const std::string& path, const std::string& text) {
  if (textOf(path) == text) return true;
  std::ofstream out(path);
  out << text << std::flush;
  std::cout << (out ? "wrote " : "cannot write ") << path << '\n';
  return static_cast<bool>(out);
}

}  // namespace

int main(int argc, char** argv) {
  std::string root = ".";
  bool only_check = false;
  CLI::App app("Parameter files and their reference, made from the tables in the code.");
  app.add_option("root", root, "root of the repository")->check(CLI::ExistingDirectory);
  app.add_flag("--check", only_check, "write nothing; fail if a file differs");
  CLI11_PARSE(app, argc, argv);

  bool good = true;
  for (const auto& [path, text] : documents())
    good = (only_check ? check : write)(root + '/' + path, text) && good;
  return good ? 0 : 1;
}
