// What every fuzz target uses: bytes read as numbers, and the rules that must hold for every input.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "helibore/error.hpp"

inline void require_rule(bool holds, const char* rule) {
    if (holds) return;
    std::fprintf(stderr, "broken rule: %s\n", rule);
    std::abort();
}

// The numbers of one input; zeros after its end.
class Input {
  public:
    Input(const std::uint8_t* bytes, std::size_t size) : bytes_(bytes, size) {}

    std::size_t left() const { return bytes_.size(); }
    std::uint8_t byte() {
        if (bytes_.empty()) return 0;
        const std::uint8_t first = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return first;
    }
    // A number in [0, count), count at most 65536.
    std::size_t below(std::size_t count) {
        const std::size_t low = byte();
        return (count <= 256 ? low : low + 256 * std::size_t{byte()}) % count;
    }
    int between(int least, int most) {
        return least + static_cast<int>(below(static_cast<std::size_t>(most - least + 1)));
    }
    bool one_in(std::size_t count) { return below(count) == count - 1; }
    double share() { return static_cast<double>(below(65536)) / 65536.0; }  // in [0, 1)
    template <class T>
    T one_of(std::initializer_list<T> values) {
        return values.begin()[below(values.size())];
    }
    // A number that breaks careless code, or any eight bytes.
    double hostile() {
        constexpr double limit_values[] = {std::numeric_limits<double>::quiet_NaN(),
                                           std::numeric_limits<double>::infinity(),
                                           -std::numeric_limits<double>::infinity(),
                                           std::numeric_limits<double>::max(),
                                           -std::numeric_limits<double>::max(),
                                           std::numeric_limits<double>::denorm_min(),
                                           0.0,
                                           -0.0,
                                           1e-200,
                                           1e155,
                                           -1.0,
                                           1e7,
                                           1e18};
        const std::size_t which = below(std::size(limit_values) + 1);
        if (which < std::size(limit_values)) return limit_values[which];
        std::uint64_t bits = 0;
        for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
        return std::bit_cast<double>(bits);
    }
    // A good value, now and then a hostile one.
    double mostly(double value) { return one_in(64) ? hostile() : value; }
    double mostly_of(std::initializer_list<double> values) { return mostly(one_of(values)); }
    std::string_view text(std::size_t size) {
        const auto part = bytes_.first(std::min(size, bytes_.size()));
        bytes_ = bytes_.subspan(part.size());
        return {reinterpret_cast<const char*>(part.data()), part.size()};
    }

  private:
    std::span<const std::uint8_t> bytes_;
};

// Knuth's MMIX generator: many values from two bytes.
class Uniform {
  public:
    explicit Uniform(std::uint64_t seed) : state_(seed) {}
    double operator()() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state_ >> 11) / 9007199254740992.0;
    }

  private:
    std::uint64_t state_;
};

inline std::uint64_t bits_of(double value) {
    return std::bit_cast<std::uint64_t>(value);
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// Does the call end with an InputError? Any other exception ends the program.
template <class Call>
bool refused(const Call& call) {
    try {
        call();
        return false;
    } catch (const helibore::InputError&) {
        return true;
    }
}

// One input of the target.
void fuzz(Input input);
