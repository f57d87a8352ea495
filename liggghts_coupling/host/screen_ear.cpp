// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/screen_ear.h"

#include <regex>
#include <utility>

namespace dem {
namespace {

constexpr std::size_t kLongestLine = 10'000;  // bytes that are kept
constexpr int kMostLines = 12;                // of an error; LIGGGHTS' longest have eight

/// The place in its source, which ends each error of LIGGGHTS.
const std::regex& source() {
  static const std::regex place(R"( ?\([^()\s]*:\d+\)\s*$)");
  return place;
}

/// Without those at its ends.
std::string without_blanks(const std::string& line) {
  constexpr const char* kBlanks = " \t\r";
  const auto begin = line.find_first_not_of(kBlanks);
  if (begin == std::string::npos) return {};
  return line.substr(begin, line.find_last_not_of(kBlanks) - begin + 1);
}

}  // namespace

std::FILE* ScreenEar::listen(std::FILE* screen) {
  screen_ = screen;
  cookie_io_functions_t functions{};
  functions.write = [](void* self, const char* text, std::size_t size) {
    static_cast<ScreenEar*>(self)->take(text, size);
    return static_cast<ssize_t>(size);
  };
  std::FILE* stream = fopencookie(this, "w", functions);
  if (stream) std::setvbuf(stream, nullptr, _IOLBF, BUFSIZ);
  return stream;
}

void ScreenEar::take(const char* text, std::size_t size) {
  if (screen_) {
    std::fwrite(text, 1, size, screen_);
    std::fflush(screen_);
  }
  for (const char* c = text; c != text + size; ++c) {
    if (*c != '\n') {
      if (line_.size() < kLongestLine) line_ += *c;
      continue;
    }
    hear(std::exchange(line_, {}));
  }
}

void ScreenEar::hear(const std::string& line) {
  if (line.starts_with("ERROR")) {
    last_error_ = without_blanks(line);
    lines_to_come_ = kMostLines;
  } else if (lines_to_come_ > 0) {
    if (const std::string more = without_blanks(line); !more.empty()) last_error_ += " " + more;
    --lines_to_come_;
  }
  if (lines_to_come_ > 0 && std::regex_search(line, source())) lines_to_come_ = 0;
  if (tell_ && line.starts_with("WARNING")) tell_(line);
}

std::string without_source(const std::string& error) {
  return std::regex_replace(error, source(), "");
}

std::string advice_for(const std::string& error) {
  const auto says = [&](const char* words) { return error.find(words) != std::string::npos; };
  if (says("left the domain"))
    return "a mesh must lie in the box, all along its way: take the scene's own, "
           "${mesh1}, which is cut at the box, or end its motion before a wall";
  if (says("assertion failed"))
    return "if the script has a mesh, it may have triangles longer than a periodic side of the "
           "box, in two dimensions "
           "than box.depth: take the scene's own, ${mesh1}, or a larger depth";
  if (says("auto_remove_duplicates"))
    return "two triangles of a mesh are one and the same, as the ends in two periodic sides of a "
           "body that goes on through them: leave these out, or take the scene's own, ${mesh1}";
  if (says("Bad mesh"))
    return "a mesh must have no long and thin triangles: take the scene's own, ${mesh1}, whose "
           "triangles are parted where they are long, or make it anew with triangles of sides "
           "that are alike";
  if (says("Internal error"))
    return "if the script has a mesh, a grain's place is no number any more, as where its centre "
           "lay in the surface of the mesh: start grains beside it, and look at what was pressed "
           "into it";
  return {};
}

}  // namespace dem
