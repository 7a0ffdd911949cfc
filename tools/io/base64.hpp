// SPDX-License-Identifier: Apache-2.0
// Base64 (RFC 4648), streamed out and decoded whole.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace gcdt::io {

/// Encodes bytes as they come; `Sink` has write(std::string_view).
template <class Sink>
class Base64Writer {
 public:
  explicit Base64Writer(Sink& sink) : sink_(sink) {}

  void put(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) {
      held_ = held_ << 8 | bytes[i];
      if (++count_ == 3) emit(4);
    }
  }
  /// Pads the last group. Nothing may be put after it.
  void finish() {
    if (count_ > 0) {
      const int digits = count_ + 1;
      for (; count_ < 3; ++count_) held_ <<= 8;
      emit(digits);
    }
    sink_.write({text_.data(), used_});
    used_ = 0;
  }

 private:
  void emit(int digits) {
    static constexpr char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int i = 0; i < 4; ++i) text_[used_++] = i < digits ? alphabet[held_ >> (18 - 6 * i) & 63] : '=';
    held_ = 0;
    count_ = 0;
    if (used_ == text_.size()) {
      sink_.write({text_.data(), used_});
      used_ = 0;
    }
  }

  Sink& sink_;
  std::array<char, 4096> text_;
  std::size_t used_ = 0;
  std::uint32_t held_ = 0;
  int count_ = 0;
};

/// Decodes `text`, blanks aside; false if it is no base64.
inline bool decode_base64(std::string_view text, std::string& bytes) {
  std::uint32_t held = 0;
  int bits = 0;
  std::size_t padding = 0;
  bytes.clear();
  bytes.reserve(text.size() / 4 * 3);
  for (char c : text) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (c == '=') {
      ++padding;
      continue;
    }
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (digit < 0 || padding > 0) return false;
    held = held << 6 | static_cast<std::uint32_t>(digit);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes += static_cast<char>(held >> bits & 255);
    }
  }
  return padding <= 2 && bits < 6;
}

}  // namespace gcdt::io
