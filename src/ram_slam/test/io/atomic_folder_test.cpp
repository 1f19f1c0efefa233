// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/io/atomic_folder.hpp"

#include <filesystem>
#include <iterator>
#include <system_error>

#include <gmock/gmock.h>
#include <unistd.h>

#include "ram_slam/io/atomic_file.hpp"

namespace ram_slam {
namespace {

class AtomicFolder : public testing::Test {
protected:
  AtomicFolder() : parent_(testing::TempDir() + "atomic_folder_" + std::to_string(::getpid())) {
    std::filesystem::create_directory(parent_);
  }
  ~AtomicFolder() override { std::filesystem::remove_all(parent_); }

  static long countIn(const std::string& folder) {
    return std::distance(std::filesystem::directory_iterator(folder),
                         std::filesystem::directory_iterator());
  }

  std::string parent_;
  std::string path_ = parent_ + "/map";
};

TEST_F(AtomicFolder, WritesAllFilesAndLeavesNothingBeside) {
  writeFolderAtomically(path_, {{"a", "1"}, {"b", std::string(100000, 'x')}});
  EXPECT_EQ(readWholeFile(path_ + "/a"), "1");
  EXPECT_EQ(readWholeFile(path_ + "/b").size(), 100000u);
  EXPECT_EQ(countIn(path_), 2);
  EXPECT_EQ(countIn(parent_), 1);
}

TEST_F(AtomicFolder, ReplacesTheOldFolderWithAllThatWasInIt) {
  writeFolderAtomically(path_, {{"a", "1"}, {"old", "2"}});
  writeFolderAtomically(path_, {{"a", "3"}});
  EXPECT_EQ(readWholeFile(path_ + "/a"), "3");
  EXPECT_EQ(countIn(path_), 1);
  EXPECT_EQ(countIn(parent_), 1);
}

TEST_F(AtomicFolder, ThatCannotBeWrittenLeavesTheOldOne) {
  writeFolderAtomically(path_, {{"a", "1"}});
  EXPECT_THROW(writeFolderAtomically(path_, {{"a", "2"}, {"no/such/folder", "3"}}),
               std::system_error);
  EXPECT_EQ(readWholeFile(path_ + "/a"), "1");
  EXPECT_EQ(countIn(parent_), 1);
}

TEST_F(AtomicFolder, DoesNotReplaceAFile) {
  writeFileAtomically(path_, "a file");
  EXPECT_THROW(writeFolderAtomically(path_, {{"a", "1"}}), std::system_error);
  EXPECT_EQ(readWholeFile(path_), "a file");
  EXPECT_EQ(countIn(parent_), 1);
}

}  // namespace
}  // namespace ram_slam
