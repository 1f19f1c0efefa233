// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "ramscout_sim/random.hpp"

namespace ramscout_sim {
namespace {

// Counters at a time, a multiple of every vector register's lanes: the compiler makes vector code
// of the loops.
constexpr std::size_t kBlock = 64;
using Words = std::array<std::uint32_t, kBlock>;

/// Counters side by side: counter j is (x0[j], x1[j], x2[j], x3[j]).
struct Counters {
  Words x0, x1, x2, x3;
};

std::uint32_t highProduct(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint32_t>((static_cast<std::uint64_t>(a) * b) >> 32);
}

template <std::size_t kCount>
void encrypt(std::uint32_t* x0,
             std::uint32_t* x1,
             std::uint32_t* x2,
             std::uint32_t* x3,
             std::array<std::uint32_t, 2> key) {
  // Multipliers and key increments of Philox 4x32-10 (Salmon et al., 2011): ten rounds.
  constexpr std::array<std::uint32_t, 2> kMultipliers = {0xD2511F53U, 0xCD9E8D57U};
  for (int round = 0; round < 10; ++round) {
    for (std::size_t j = 0; j < kCount; ++j) {
      const std::uint32_t high0 = highProduct(kMultipliers[0], x0[j]);
      const std::uint32_t high1 = highProduct(kMultipliers[1], x2[j]);
      const std::uint32_t low0 = kMultipliers[0] * x0[j];
      const std::uint32_t low1 = kMultipliers[1] * x2[j];
      x0[j] = high1 ^ x1[j] ^ key[0];
      x2[j] = high0 ^ x3[j] ^ key[1];
      x1[j] = low1;
      x3[j] = low0;
    }
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
}

float asFloat(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

std::uint32_t asBits(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return bits;
}

/// Uniform in (0, 1].
float uniform(std::uint32_t bits) {
  return (static_cast<float>(static_cast<std::int32_t>(bits >> 1)) + 0.5F) * 0x1p-31F;
}

/// For numbers in (0, 1] that are not denormal (Cephes, logf).
float naturalLogarithm(float x) {
  const std::uint32_t bits = asBits(x);
  float exponent = static_cast<float>(static_cast<std::int32_t>(bits >> 23) - 126);
  float m = asFloat((bits & 0x007FFFFFU) | 0x3F000000U);  // in [0.5, 1)
  const bool small = m < 0.70710678F;
  exponent -= small ? 1.0F : 0.0F;
  m = (small ? m + m : m) - 1.0F;
  const float square = m * m;
  float y = 7.0376836292e-2F;
  y = y * m - 1.1514610310e-1F;
  y = y * m + 1.1676998740e-1F;
  y = y * m - 1.2420140846e-1F;
  y = y * m + 1.4249322787e-1F;
  y = y * m - 1.6668057665e-1F;
  y = y * m + 2.0000714765e-1F;
  y = y * m - 2.4999993993e-1F;
  y = y * m + 3.3333331174e-1F;
  y = y * m * square - 2.12194440e-4F * exponent - 0.5F * square;
  return m + y + 0.693359375F * exponent;
}

/// Two independent normal numbers from two random words.
void boxMuller(const Words& length_bits, const Words& angle_bits, float* first, float* second) {
  for (std::size_t j = 0; j < kBlock; ++j) {
    const float radius = std::sqrt(-2.0F * naturalLogarithm(uniform(length_bits[j])));
    // The upper two bits choose the quadrant, the others an angle of -45 to 45 degrees in it.
    const std::uint32_t bits = angle_bits[j];
    const float a =
        (static_cast<float>(static_cast<std::int32_t>(bits & 0x3FFFFFFFU)) * 0x1p-30F - 0.5F) *
        1.57079632679F;
    const float square = a * a;
    const float sine =
        ((-1.9515295891e-4F * square + 8.3321608736e-3F) * square - 1.6666654611e-1F) * square * a +
        a;
    const float cosine = ((2.443315711809948e-5F * square - 1.388731625493765e-3F) * square +
                          4.166664568298827e-2F) *
                             square * square -
                         0.5F * square + 1.0F;
    const bool swapped = (bits & 0x40000000U) != 0;
    const float x = swapped ? sine : cosine;
    const float y = swapped ? cosine : sine;
    const std::uint32_t sign = bits & 0x80000000U;
    first[j] = asFloat(asBits(radius * x) ^ sign);
    second[j] = asFloat(asBits(radius * y) ^ sign ^ ((bits & 0x40000000U) << 1));
  }
}

}  // namespace

std::array<std::uint32_t, 4> philox(const std::array<std::uint32_t, 4>& counter,
                                    const std::array<std::uint32_t, 2>& key) {
  std::array<std::uint32_t, 4> x = counter;
  encrypt<1>(&x[0], &x[1], &x[2], &x[3], key);
  return x;
}

std::vector<float> gaussians(Random key, std::size_t count) {
  constexpr std::size_t per_block = 4 * kBlock;  // a counter gives four
  const std::size_t blocks = (count + per_block - 1) / per_block;
  const std::uint64_t key_bits = key.bits();
  const std::uint64_t stream_bits = key.bits();
  std::vector<float> numbers(blocks * per_block);
  for (std::size_t block = 0; block < blocks; ++block) {
    Counters c;  // NOLINT(cppcoreguidelines-pro-type-member-init): every field is set below
    for (std::size_t j = 0; j < kBlock; ++j)
      c.x0[j] = static_cast<std::uint32_t>(block * kBlock + j);
    c.x1.fill(0);
    c.x2.fill(static_cast<std::uint32_t>(stream_bits));
    c.x3.fill(static_cast<std::uint32_t>(stream_bits >> 32));
    encrypt<kBlock>(
        c.x0.data(), c.x1.data(), c.x2.data(), c.x3.data(),
        {static_cast<std::uint32_t>(key_bits), static_cast<std::uint32_t>(key_bits >> 32)});
    float* out = numbers.data() + block * per_block;
    boxMuller(c.x0, c.x1, out, out + kBlock);
    boxMuller(c.x2, c.x3, out + 2 * kBlock, out + 3 * kBlock);
  }
  numbers.resize(count);
  return numbers;
}

}  // namespace ramscout_sim
