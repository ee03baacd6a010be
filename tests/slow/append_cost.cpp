// What an append of 1,000 samples costs through the C interface beside C++: processor time of the two, in turns, on
// walls that get the same samples. tests/slow/guest.py builds and runs it.
#include <helibore/helibore.h>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <helibore/wall.hpp>

int main() {
    constexpr int n = 1000, packets = 1500;
    std::vector<double> depth(n), toolface(n), radius(n), ratios;
    for (int round = 0; round < 9; ++round) {
        helibore::Wall wall({.bit_diameter = 0.216, .start_depth = 1000.0});
        hb_settings settings = {};
        settings.size = sizeof settings;
        hb_settings_init(&settings);
        settings.bit_diameter = 0.216;
        settings.start_depth = 1000.0;
        std::int64_t handle = 0;
        hb_wall_create(&settings, &handle);
        hb_change change = {};
        change.size = sizeof change;
        std::clock_t spent[2] = {};
        for (int packet = 0; packet < packets; ++packet) {
            for (std::size_t i = 0; i < n; ++i) {
                depth[i] = 1000.0 + 0.1 * packet + static_cast<double>(i) * 1e-4;
                toolface[i] = static_cast<double>(i * 37 % 360);
                radius[i] = 0.11 + static_cast<double>(i % 7) * 1e-3;
            }
            for (const int turn : {packet % 2, 1 - packet % 2}) {
                const std::clock_t began = std::clock();
                if (turn == 0)
                    wall.append({depth, toolface, radius});
                else if (hb_wall_append(handle, n, depth.data(), toolface.data(), radius.data(), nullptr, &change) !=
                         HB_OK)
                    return 1;
                spent[turn] += std::clock() - began;
            }
        }
        hb_close(handle);
        ratios.push_back(static_cast<double>(spent[1]) / static_cast<double>(spent[0]));
        std::printf("C++ %.1f us, C %.1f us an append\n", 1e6 * double(spent[0]) / CLOCKS_PER_SEC / packets,
                    1e6 * double(spent[1]) / CLOCKS_PER_SEC / packets);
    }
    std::sort(ratios.begin(), ratios.end());
    std::printf("C / C++: median %.3f, %.3f to %.3f\n", ratios[4], ratios.front(), ratios.back());
    return ratios[4] <= 1.02 ? 0 : 1;
}
