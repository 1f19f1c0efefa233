// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/named_file.hpp"

#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

using ::testing::StrEq;
using ::testing::ThrowsMessage;

template <typename Error>
auto failure(const std::string& text) {
  return [text] { namingFile("a.bag", [&text]() -> int { throw Error(text); }); };
}

TEST(NamingFile, PutsThePathBeforeATextThatLacksIt) {
  EXPECT_EQ(namingFile("a.bag", [] { return 3; }), 3);
  EXPECT_THAT(failure<std::runtime_error>("no scans"),
              ThrowsMessage<std::runtime_error>(StrEq("a.bag: no scans")));
  EXPECT_THAT(failure<std::invalid_argument>("no scans"),
              ThrowsMessage<std::invalid_argument>(StrEq("a.bag: no scans")));
  EXPECT_THAT(failure<std::runtime_error>("a.bag has no scans"),
              ThrowsMessage<std::runtime_error>(StrEq("a.bag has no scans")));
}

}  // namespace
}  // namespace ramscout_bringup
