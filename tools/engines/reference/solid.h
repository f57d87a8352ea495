// SPDX-License-Identifier: MIT
/// bplbm_solid.h for a program in C++: what fails is thrown, and the conversation ends with
/// `close`.
#pragma once

#include <cstdint>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "bplbm_solid.h"

/// The conversation has failed: bplbm_error has the sentence, and bplbm_close tells it to the
/// fluid.
struct Failed : std::exception {};

class Solid {
 public:
  explicit Solid(const char* program, const char* version) {
    bplbm_connect(&wire_, program, version);
  }
  Solid(const Solid&) = delete;
  Solid& operator=(const Solid&) = delete;

  /// @return the exit code of the program
  int close() { return bplbm_close(wire_); }

  /// What both programs end with, unless the conversation has failed before.
  void note(int code, const std::string& sentence) const {
    bplbm_fail(wire_, code, sentence.c_str());
  }
  [[noreturn]] void fail(int code, const std::string& sentence) const {
    note(code, sentence);
    throw Failed();
  }

  bplbm_setup scene() const {
    bplbm_setup setup{};
    check(bplbm_scene(wire_, &setup));
    return setup;
  }
  void agree(const bplbm_setup& setup) const { check(bplbm_agree(wire_, &setup)); }

  bool has(const std::string& name) const { return bplbm_variable(wire_, name.c_str()) != nullptr; }
  /// Empty where the scene offers no such variable.
  std::string text(const std::string& name) const {
    const char* found = bplbm_variable(wire_, name.c_str());
    return found ? found : "";
  }
  double number(const std::string& name) const {
    double value = 0.0;
    check(bplbm_number(wire_, name.c_str(), &value));
    return value;
  }
  double number_or(const std::string& name, double otherwise) const {
    return has(name) ? number(name) : otherwise;
  }

  /// The carrier of a clump of spheres, and where its centre is among them. @param places  [n][3]
  bplbm_shape clump(std::span<const double> places, std::span<const double> radii, double density,
                    double* centre) const {
    bplbm_shape carrier{};
    check(bplbm_clump(wire_, static_cast<std::int64_t>(radii.size()), places.data(), radii.data(),
                      density, &carrier, centre, nullptr));
    return carrier;
  }

  /// @return  what the fluid asks for: BPLBM_LAST …
  std::uint32_t exchange(std::span<const bplbm_state> states, std::span<const bplbm_shape> shapes,
                         std::vector<bplbm_load>& loads) const {
    std::uint32_t asked = 0;
    loads.resize(states.size());
    check(bplbm_exchange(wire_, static_cast<std::int64_t>(states.size()), states.data(),
                         shapes.data(), loads.data(), &asked));
    return asked;
  }
  void keep(const std::string& part) const {
    check(bplbm_checkpoint(wire_, part.data(), static_cast<std::int64_t>(part.size())));
  }

 private:
  static void check(int code) {
    if (code != BPLBM_OK) throw Failed();
  }
  bplbm_solid* wire_ = nullptr;
};
