// Pages that walls hand on to each other: kept up to a limit, shared by threads, outlived by walls, and without a say
// in what comes out.
#include "helibore/pages.hpp"

#include <algorithm>
#include <memory>
#include <thread>

#include "check.hpp"
#include "hole.hpp"

namespace {

using helibore::page_size;
using helibore::Pages;
using helibore::Settings;
using helibore::Wall;

const Settings settings{.bit_diameter = 0.216, .sectors = 32, .pitch = 0.2};

std::vector<std::uint64_t> rebuilt(const Hole& hole, std::shared_ptr<Pages> pages) {
    Wall wall(settings, std::move(pages));
    wall.append(hole.all());
    return bits(wall);
}

// 120,000 timed samples take a page and more than three quarters of another.
void handed_on() {
    const Hole first = oval_hole(120'000, 10.0, 20.0), second = oval_hole(120'000, 500.0, 20.0);
    const auto pages = std::make_shared<Pages>(8 * page_size);
    CHECK(pages->kept() == 0);
    CHECK(rebuilt(first, pages) == rebuilt(first, nullptr));
    CHECK(pages->kept() == 2 * page_size);
    {
        Wall wall(settings, pages);
        wall.append(second.all());
        CHECK(pages->kept() == 0);  // the wall has them
        CHECK(bits(wall) == rebuilt(second, nullptr));
    }
    CHECK(pages->kept() == 2 * page_size);
    pages->release();
    CHECK(pages->kept() == 0);
}

void not_beyond_the_limit() {
    const auto pages = std::make_shared<Pages>(2 * page_size + 1);
    std::vector<std::shared_ptr<double[]>> held;
    for (int i = 0; i < 5; ++i) {
        held.push_back(pages->take());
        held.back()[0] = held.back()[page_size / sizeof(double) - 1] = i;  // all of it is there
    }
    for (std::size_t i = 0; i < 5; ++i) CHECK(held[i][0] == static_cast<double>(i));
    held.clear();
    CHECK(pages->kept() == 2 * page_size);

    const auto none = std::make_shared<Pages>();
    none->take();
    CHECK(none->kept() == 0);
}

void outlived() {
    auto pages = std::make_shared<Pages>(4 * page_size);
    const std::weak_ptr<Pages> seen = pages;
    {
        const std::shared_ptr<double[]> page = pages->take();
        pages.reset();
        page[1] = 1.0;
        CHECK(!seen.expired());
    }
    CHECK(seen.expired());
}

// Threads that build and drop walls at once: none gets a page that another still has.
void shared_by_threads() {
    const Hole hole = oval_hole(50'000, 10.0, 10.0);
    const std::vector<std::uint64_t> expected = rebuilt(hole, nullptr);
    const auto pages = std::make_shared<Pages>(3 * page_size);
    std::vector<int> wrong(4, 0);
    std::vector<std::thread> threads;
    for (int& count : wrong)
        threads.emplace_back([&] {
            for (int i = 0; i < 8; ++i) count += rebuilt(hole, pages) != expected;
        });
    for (std::thread& thread : threads) thread.join();
    CHECK(std::count(wrong.begin(), wrong.end(), 0) == 4);
    CHECK(pages->kept() <= 3 * page_size);
}

}  // namespace

int main() {
    handed_on();
    not_beyond_the_limit();
    outlived();
    shared_by_threads();
    return failures();
}
