// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Functions marked with this also exist in a form for processors with wider registers, chosen when
// the program starts. The results are the same to the bit.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RAMSCOUT_WIDE_REGISTERS __attribute__((target_clones("avx2", "default")))
#else
#define RAMSCOUT_WIDE_REGISTERS
#endif
