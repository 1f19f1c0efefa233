// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>

#include <Eigen/Core>

namespace ram_slam {

/// Appends numbers to a string of bytes, little-endian on every machine.
class BinaryWriter {
public:
  /// Any arithmetic type, in as many bytes as it has.
  template <typename Number, typename = std::enable_if_t<std::is_arithmetic_v<Number>>>
  void write(Number value) {
    std::uint64_t bits = 0;
    static_assert(sizeof(Number) <= sizeof bits);
    if constexpr (std::is_integral_v<Number>) {
      bits = static_cast<std::uint64_t>(value);
    } else if constexpr (sizeof(Number) == sizeof(std::uint32_t)) {
      std::uint32_t narrow = 0;
      std::memcpy(&narrow, &value, sizeof narrow);
      bits = narrow;
    } else {
      std::memcpy(&bits, &value, sizeof bits);
    }
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(static_cast<char>(bits >> (8 * i)));
  }
  void write(const std::string& text) {
    write(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
  }
  /// Row by row.
  template <typename Derived>
  void write(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      for (Eigen::Index column = 0; column < matrix.cols(); ++column) write(matrix(row, column));
    }
  }
  const std::string& bytes() const { return bytes_; }

private:
  std::string bytes_;
};

/// Reads what BinaryWriter wrote. Every function throws std::runtime_error where the bytes end too
/// early.
class BinaryReader {
public:
  explicit BinaryReader(const std::string& bytes, std::size_t position = 0)
      : bytes_(bytes), position_(position) {}

  template <typename Number>
  Number read() {
    require(sizeof(Number));
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[position_ + i]))
              << (8 * i);
    }
    position_ += sizeof(Number);
    if constexpr (std::is_integral_v<Number>) {
      return static_cast<Number>(bits);
    } else {
      using Bits =
          std::conditional_t<sizeof(Number) == sizeof(std::uint32_t), std::uint32_t, std::uint64_t>;
      const Bits narrow = static_cast<Bits>(bits);
      Number value{};
      std::memcpy(&value, &narrow, sizeof value);
      return value;
    }
  }
  std::string readText() {
    const std::size_t size = readCount(1);
    position_ += size;
    return bytes_.substr(position_ - size, size);
  }
  template <typename Matrix>
  Matrix readMatrix() {
    Matrix matrix;
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
        matrix(row, column) = read<typename Matrix::Scalar>();
      }
    }
    return matrix;
  }
  /// A number of things that take at least so many bytes each: never more than the rest can hold.
  std::size_t readCount(std::size_t bytes_each) {
    const auto count = read<std::uint64_t>();
    if (count > (bytes_.size() - position_) / bytes_each)
      throw std::runtime_error("it is cut short");
    return static_cast<std::size_t>(count);
  }
  std::size_t position() const { return position_; }
  bool atEnd() const { return position_ == bytes_.size(); }

private:
  void require(std::size_t count) const {
    if (bytes_.size() - position_ < count) throw std::runtime_error("it is cut short");
  }

  const std::string& bytes_;
  std::size_t position_;
};

}  // namespace ram_slam
