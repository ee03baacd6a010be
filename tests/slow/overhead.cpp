// What an append of 1,000 costs through the C interface, over C++: the two take turns on two walls that grow alike, and
// the median of the ratios of their processor times counts.
#include <helibore/helibore.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <helibore/wall.hpp>

namespace {

double seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void check(std::int32_t status) {
    if (status == HB_OK) return;
    std::puts(hb_last_error());
    std::exit(1);
}

}  // namespace

int main() {
    constexpr int appends = 3000;
    constexpr std::size_t rows = 1000;
    hb_settings settings = {};
    settings.size = sizeof settings;
    check(hb_settings_init(&settings));
    settings.bit_diameter = 0.216;
    settings.start_depth = 1000.0;
    std::int64_t in_c = 0;
    check(hb_wall_create(&settings, &in_c));
    helibore::Wall in_cpp({.bit_diameter = 0.216, .start_depth = 1000.0});
    std::vector<double> depth(rows), toolface(rows), radius(rows), time(rows), ratios;
    double c = 0.0, cpp = 0.0;
    for (int i = 0; i < appends; ++i) {
        for (std::size_t j = 0; j < rows; ++j) {
            const double t = i + static_cast<double>(j) / rows;
            depth[j] = 1000.0 + t;
            toolface[j] = static_cast<double>((i * 1000 + static_cast<int>(j)) * 37 % 360);
            radius[j] = 0.11 + 0.001 * static_cast<double>(j % 7);
            time[j] = t;
        }
        double took[2] = {};
        for (const int turn : {i % 2, 1 - i % 2}) {
            const double began = seconds();
            if (turn == 0) {
                hb_change change = {};
                change.size = sizeof change;
                check(hb_wall_append(in_c, rows, depth.data(), toolface.data(), radius.data(), time.data(), &change));
            } else {
                in_cpp.append({depth, toolface, radius, time});
            }
            took[turn] = seconds() - began;
        }
        c += took[0];
        cpp += took[1];
        ratios.push_back(took[0] / took[1]);
    }
    std::nth_element(ratios.begin(), ratios.begin() + appends / 2, ratios.end());
    std::printf("an append of 1,000: %.1f us in C, %.1f us in C++; the median of %d ratios is %.4f\n",
                1e6 * c / appends, 1e6 * cpp / appends, appends, ratios[appends / 2]);
    return ratios[appends / 2] <= 1.02 ? 0 : 1;
}
