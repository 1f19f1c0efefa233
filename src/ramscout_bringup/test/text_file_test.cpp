// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/text_file.hpp"

#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <boost/iostreams/copy.hpp>
#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filter/lzma.hpp>
#include <boost/iostreams/filtering_stream.hpp>
#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

template <typename Compressor>
std::string packed(const std::string& text, const Compressor& compressor) {
  std::istringstream source(text);
  std::ostringstream target;
  boost::iostreams::filtering_ostream filter;
  filter.push(compressor);
  filter.push(target);
  boost::iostreams::copy(source, filter);
  return target.str();
}

class TextFileTest : public testing::Test {
protected:
  std::string write(const std::string& content) {
    std::ofstream(path_, std::ios::binary) << content;
    return path_;
  }
  static std::vector<std::string> linesOf(const std::string& path) {
    TextFile file(path);
    std::vector<std::string> lines;
    while (const auto line = file.nextLine()) lines.emplace_back(*line);
    return lines;
  }
  void TearDown() override { std::remove(path_.c_str()); }

  std::string path_ = testing::TempDir() + "text_file_test.txt";
};

const std::vector<std::string> kLines = {"first", "", "third"};

TEST_F(TextFileTest, LinesComeWithoutTheirEndsOfEitherKind) {
  EXPECT_EQ(linesOf(write("first\n\nthird\n")), kLines);
  EXPECT_EQ(linesOf(write("first\r\n\r\nthird\r\n")), kLines);
}

TEST_F(TextFileTest, TheLastLineNeedsNoEnd) {
  EXPECT_EQ(linesOf(write("first\n\nthird")), kLines);
}

TEST_F(TextFileTest, AnEmptyFileHasNoLine) {
  EXPECT_TRUE(linesOf(write("")).empty());
}

TEST_F(TextFileTest, PackedFilesAreRecognisedByTheirContent) {
  const std::string text = "first\n\nthird\n";
  EXPECT_EQ(linesOf(write(packed(text, boost::iostreams::gzip_compressor()))), kLines);
  EXPECT_EQ(linesOf(write(packed(text, boost::iostreams::lzma_compressor()))), kLines);
}

TEST_F(TextFileTest, APlainFileMayBeginLikeAnything) {
  EXPECT_EQ(linesOf(write("\xfd"
                          "7z"))
                .size(),
            1U)
      << "half of the mark of xz";
  EXPECT_EQ(linesOf(write("\x1f")).size(), 1U) << "half of the mark of gzip";
}

TEST_F(TextFileTest, ADamagedPackedFileIsAnErrorThatNamesIt) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += std::to_string(i * i) + "\n";
  for (std::string content : {packed(text, boost::iostreams::gzip_compressor()),
                              packed(text, boost::iostreams::lzma_compressor())}) {
    for (std::size_t at = content.size() / 2; at < content.size() / 2 + 20; ++at)
      content[at] = static_cast<char>(~content[at]);
    try {
      linesOf(write(content));
      FAIL() << "accepted";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path_), std::string::npos) << error.what();
    }
  }
}

TEST_F(TextFileTest, AFileThatDoesNotExistIsAnErrorThatNamesIt) {
  try {
    TextFile file("/nowhere/log.clf");
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/log.clf"), std::string::npos);
  }
}

TEST_F(TextFileTest, EveryTruncationOfAPackedFileIsRefused) {
  const std::string text = "first\n\nthird\n";
  for (const std::string& whole : {packed(text, boost::iostreams::gzip_compressor()),
                                   packed(text, boost::iostreams::lzma_compressor())}) {
    for (std::size_t size = 6; size < whole.size(); ++size)
      EXPECT_THROW(linesOf(write(whole.substr(0, size))), std::runtime_error) << size;
    EXPECT_EQ(linesOf(write(whole)), kLines);
  }
}

TEST_F(TextFileTest, PackedFilesBehindEachOtherAreOneText) {
  const std::string twice = packed("first\n\n", boost::iostreams::gzip_compressor()) +
                            packed("third\n", boost::iostreams::gzip_compressor());
  EXPECT_EQ(linesOf(write(twice)), kLines);
}

TEST_F(TextFileTest, APackedFileOfOneEndlessLineIsRefusedSoon) {
  const std::string file =
      write(packed(std::string(40'000'000, 'x'), boost::iostreams::gzip_compressor()));
  EXPECT_THAT([&] { linesOf(file); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("a line has more")));
}

TEST_F(TextFileTest, ALineMayBeLongAndHoldAnyByte) {
  std::string line(300000, 'x');
  line[1000] = '\0';
  line[2000] = '\xff';
  EXPECT_EQ(linesOf(write(line + "\nend\n")), (std::vector<std::string>{line, "end"}));
}

}  // namespace
}  // namespace ramscout_bringup
