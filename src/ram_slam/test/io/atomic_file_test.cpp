// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/io/atomic_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ram_slam {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// A folder of its own for a test, removed at its end.
class AtomicFile : public testing::Test {
protected:
  AtomicFile() : folder_(testing::TempDir() + "atomic_file_" + std::to_string(::getpid())) {
    std::filesystem::create_directory(folder_);
  }
  ~AtomicFile() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  long fileCount() const {
    return std::distance(std::filesystem::directory_iterator(folder_),
                         std::filesystem::directory_iterator());
  }

  std::string folder_;
};

TEST_F(AtomicFile, IsReadBackAsWritten) {
  const std::string content("a\0b\xff\n", 5);
  writeFileAtomically(path("file"), content);
  EXPECT_EQ(readWholeFile(path("file"), 100), content);
  writeFileAtomically(path("file"), "");
  EXPECT_EQ(readWholeFile(path("file"), 0), "");
  EXPECT_EQ(fileCount(), 1);
}

TEST_F(AtomicFile, FullDiskKeepsTheOldFileAndLeavesNothingBehind) {
  writeFileAtomically(path("file"), "old");
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  struct rlimit small = before;
  small.rlim_cur = 1000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THAT([&] { writeFileAtomically(path("file"), std::string(5000, 'x')); },
              ThrowsMessage<std::system_error>(HasSubstr("File too large")));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(readWholeFile(path("file"), 100), "old");
  EXPECT_EQ(fileCount(), 1);
  // A device that is always full: the write itself fails.
  EXPECT_THROW(writeFileAtomically("/dev/full/file", "x"), std::system_error);
}

TEST_F(AtomicFile, WriterKilledAtAnyMomentLeavesTheOldFileOrTheNewOne) {
  const std::string old_content(300000, 'o');
  const std::string new_content(400000, 'n');
  writeFileAtomically(path("file"), old_content);
  for (int attempt = 0; attempt < 60; ++attempt) {
    const pid_t writer = ::fork();
    ASSERT_GE(writer, 0);
    if (writer == 0) {
      for (;;) {
        writeFileAtomically(path("file"), new_content);
        writeFileAtomically(path("file"), old_content);
      }
    }
    ::usleep(static_cast<useconds_t>(300 * attempt));
    ::kill(writer, SIGKILL);
    ::waitpid(writer, nullptr, 0);
    const std::string content = readWholeFile(path("file"), 1000000);
    ASSERT_TRUE(content == old_content || content == new_content) << attempt;
  }
}

TEST_F(AtomicFile, FailuresNameTheFileAndTheSystemsReason) {
  EXPECT_THAT([&] { writeFileAtomically(path("missing/file"), "x"); },
              ThrowsMessage<std::system_error>(testing::AllOf(
                  HasSubstr("missing/file"), HasSubstr("No such file or directory"))));
  std::filesystem::create_directory(path("folder"));
  EXPECT_THAT([&] { writeFileAtomically(path("folder"), "x"); },
              ThrowsMessage<std::system_error>(HasSubstr("directory")));
  EXPECT_EQ(fileCount(), 1);
  EXPECT_THROW(readWholeFile(path("nothing"), 10), std::system_error);
  EXPECT_THROW(readWholeFile(path("folder"), 10), std::system_error);
  EXPECT_THROW(readWholeFile("/dev/zero", 10), std::system_error);
}

TEST_F(AtomicFile, LongerFilesThanAllowedAreNotRead) {
  writeFileAtomically(path("file"), std::string(11, 'x'));
  EXPECT_THROW(readWholeFile(path("file"), 10), std::length_error);
}

TEST(PathInFolder, TakesPlainNamesOnly) {
  EXPECT_EQ(pathInFolder("/maps", "office-2.v1_b"), "/maps/office-2.v1_b");
  for (const std::string& name :
       {std::string(), std::string("."), std::string(".."), std::string("../x"),
        std::string("/etc/x"), std::string("a/b"), std::string(".hidden"), std::string("a b"),
        std::string("a;rm"), std::string("$(x)"), std::string("`x`"), std::string("\xc3\xa4"),
        std::string("a\0b", 3), std::string(101, 'a'), std::string(5000, 'a')}) {
    EXPECT_THROW(pathInFolder("/maps", name), std::invalid_argument) << name;
  }
}

TEST(ExpandHome, ReplacesALeadingTildeByTheHomeFolder) {
  const char* home = std::getenv("HOME");
  ASSERT_NE(home, nullptr);
  EXPECT_EQ(expandHome("~"), home);
  EXPECT_EQ(expandHome("~/maps"), std::string(home) + "/maps");
  for (const char* other : {"/maps", "maps", "", "~other/maps", "maps/~"})
    EXPECT_EQ(expandHome(other), other);
}

TEST_F(AtomicFile, WhatAKilledWriterLeftBehindIsNoObstacle) {
  // Killed between the write and the rename: the temporary file is there, the old one is whole.
  writeFileAtomically(path("file"), "old");
  const std::string temporary = path("file.writing-" + std::to_string(::getpid()));
  std::ofstream(temporary) << "half of the n";
  EXPECT_EQ(readWholeFile(path("file"), 100), "old");
  writeFileAtomically(path("file"), "new");
  EXPECT_EQ(readWholeFile(path("file"), 100), "new");
  EXPECT_EQ(fileCount(), 1);
}

TEST_F(AtomicFile, AReaderOfTheOldFileReadsItToTheEnd) {
  writeFileAtomically(path("file"), std::string(100000, 'o'));
  std::ifstream reader(path("file"));
  std::string begin(10, ' ');
  reader.read(begin.data(), 10);
  writeFileAtomically(path("file"), std::string(100000, 'n'));
  const std::string rest((std::istreambuf_iterator<char>(reader)),
                         std::istreambuf_iterator<char>());
  EXPECT_EQ(begin + rest, std::string(100000, 'o'));
}

TEST_F(AtomicFile, ALinkIsReplacedAndWhatItPointsToStays) {
  writeFileAtomically(path("target"), "target");
  std::filesystem::create_symlink(path("target"), path("link"));
  writeFileAtomically(path("link"), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(path("link")));
  EXPECT_EQ(readWholeFile(path("target"), 100), "target");
}

TEST_F(AtomicFile, ADeviceIsWrittenToAndStaysADevice) {
  EXPECT_THAT([] { writeFileAtomically("/dev/full", "x"); },
              ThrowsMessage<std::system_error>(HasSubstr("No space left")));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  writeFileAtomically(path("pipe"), "text");
  char text[5] = {};
  EXPECT_EQ(::read(reader, text, 4), 4);
  EXPECT_STREQ(text, "text");
  ::close(reader);
  EXPECT_TRUE(std::filesystem::is_fifo(path("pipe")));
}

TEST_F(AtomicFile, WhatAWriterThatIsNoMoreLeftBehindIsRemovedByTheNextSave) {
  const pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  ::waitpid(gone, nullptr, 0);
  std::ofstream(path("other.writing-" + std::to_string(gone))) << "half";
  std::ofstream(path("other.writing-" + std::to_string(::getppid()))) << "in work";
  std::ofstream(path("other.writing-notes")) << "a user's";
  std::filesystem::create_directory(path("map.writing-" + std::to_string(gone)));
  std::ofstream(path("map.writing-" + std::to_string(gone)) + "/image") << "half";
  writeFileAtomically(path("file"), "new");
  EXPECT_EQ(fileCount(), 3);
  EXPECT_FALSE(std::filesystem::exists(path("other.writing-" + std::to_string(gone))));
}

TEST_F(AtomicFile, AFileOfExactlyTheMostBytesIsRead) {
  writeFileAtomically(path("file"), "12345");
  EXPECT_EQ(readWholeFile(path("file"), 5), "12345");
  EXPECT_THAT([&] { readWholeFile(path("file"), 4); },
              ThrowsMessage<std::length_error>(HasSubstr("it has 5 bytes, at most 4 are taken")));
}

}  // namespace
}  // namespace ram_slam
