// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <console_bridge/console.h>

namespace ramscout_sim {

/// Collects what urdfdom complains about while this object lives.
class ParserLog : public console_bridge::OutputHandler {
public:
  ParserLog() { console_bridge::useOutputHandler(this); }
  ~ParserLog() override { console_bridge::restorePreviousOutputHandler(); }
  ParserLog(const ParserLog&) = delete;
  ParserLog& operator=(const ParserLog&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR)
      errors_ += (errors_.empty() ? "" : "; ") + text;
  }
  const std::string& errors() const { return errors_; }

private:
  std::string errors_;
};

}  // namespace ramscout_sim
