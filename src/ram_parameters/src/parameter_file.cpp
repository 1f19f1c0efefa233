// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/parameter_file.hpp"

#include <algorithm>
#include <sstream>

namespace ram_parameters {
namespace {

constexpr std::size_t kColumns = 120;       // of the shipped files
constexpr std::size_t kCommentColumn = 40;  // where a short comment begins

std::string comment(const ParameterRow& row) {
  std::string text = row.text;
  if (!row.unit.empty()) text += (text.empty() ? "[" : " [") + row.unit + "]";
  if (!row.range.empty()) text += (text.empty() ? "" : text.back() == '.' ? " " : ", ") + row.range;
  return text;
}

void writeWrapped(std::ostream& out, const std::string& text, const std::string& indent) {
  std::istringstream words(text);
  std::string word;
  std::size_t column = kColumns;
  bool first = true;
  while (words >> word) {
    if (column + 1 + word.size() > kColumns) {
      out << (first ? "" : "\n") << indent << "#";
      column = indent.size() + 1;
      first = false;
    }
    out << ' ' << word;
    column += 1 + word.size();
  }
  if (!first) out << '\n';
}

std::size_t depth(const std::string& key) {
  return static_cast<std::size_t>(std::count(key.begin(), key.end(), '/'));
}

/// Opens the sections of `key` that `before` was not in.
void writeSections(std::ostream& out, const std::string& before, const std::string& key) {
  std::size_t begin = 0;
  for (std::size_t level = 0; level < depth(key); ++level) {
    const std::size_t end = key.find('/', begin);
    if (before.compare(0, end + 1, key, 0, end + 1) != 0)
      out << '\n' << std::string(2 * level, ' ') << key.substr(begin, end - begin) << ":\n";
    begin = end + 1;
  }
}

void writeRow(std::ostream& out, const ParameterRow& row) {
  const std::string indent(2 * depth(row.key), ' ');
  const std::string assignment = indent + row.key.substr(row.key.rfind('/') + 1) + ": " + row.value;
  const std::string note = comment(row);
  const std::size_t column = std::max(assignment.size() + 1, kCommentColumn);
  if (note.empty()) {
    out << assignment << '\n';
  } else if (column + 2 + note.size() <= kColumns) {
    out << assignment << std::string(column - assignment.size(), ' ') << "# " << note << '\n';
  } else {
    writeWrapped(out, note, indent);
    out << assignment << '\n';
  }
}

}  // namespace

void append(std::vector<ParameterRow>& rows,
            const std::vector<ParameterRow>& more,
            const std::string& section) {
  for (ParameterRow row : more) {
    if (!section.empty()) row.key.insert(0, section + "/");
    rows.push_back(std::move(row));
  }
}

std::string toYaml(const ParameterFile& file) {
  std::ostringstream out;
  writeWrapped(out, "Parameters of " + file.node + ". " + file.intro, "");
  writeWrapped(out,
               "Made from the tables in the code by `make parameters`; docs/parameters.md lists "
               "these and the parameters for experts.",
               "");
  std::string before;
  std::string heading;
  for (const ParameterRow& row : file.rows) {
    if (row.is_expert) continue;
    if (!row.heading.empty()) heading = row.heading;
    writeSections(out, before, row.key);
    if (!heading.empty()) {
      const std::string indent(2 * depth(row.key), ' ');
      out << '\n';
      writeWrapped(out, "--- " + heading, indent);
    } else if (before.empty()) {
      out << '\n';
    }
    heading.clear();
    writeRow(out, row);
    before = row.key;
  }
  return out.str();
}

std::string toMarkdown(const ParameterFile& file) {
  std::ostringstream out;
  out << "## " << file.node << "\n\n"
      << file.intro << " Shipped as `config/" << file.name << "`.\n\n"
      << "| parameter | default | unit | range | what it decides |\n|---|---|---|---|---|\n";
  for (const ParameterRow& row : file.rows) {
    if (!row.heading.empty()) out << "| **" << row.heading << "** | | | | |\n";
    out << "| `" << row.key << "`" << (row.is_expert ? " *(expert)*" : "") << " | `" << row.value
        << "` | " << row.unit << " | " << row.range << " | " << row.text << " |\n";
  }
  return out.str();
}

}  // namespace ram_parameters
