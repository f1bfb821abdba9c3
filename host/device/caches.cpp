#include "device/caches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace raymill {

namespace {

/// The first word of a file; empty if there is none.
std::string word_in(const std::string& file) {
    std::ifstream in(file);
    std::string word;
    in >> word;
    return word;
}

/// "48K" to bytes; 0 if it is no size.
std::uint64_t cache_size(const std::string& text) {
    std::uint64_t number = 0;
    char unit = ' ';
    if (std::sscanf(text.c_str(), "%lu%c", &number, &unit) < 1) return 0;
    return unit == 'K' ? number << 10 : unit == 'M' ? number << 20 : number;
}

}  // namespace

unsigned count_threads(const std::string& list) {
    std::istringstream ranges(list);
    unsigned count = 0;
    for (std::string range; std::getline(ranges, range, ',');) {
        unsigned first = 0, last = 0;
        const int numbers = std::sscanf(range.c_str(), "%u-%u", &first, &last);
        if (numbers >= 1) count += numbers == 2 && last >= first ? last - first + 1 : 1;
    }
    return std::max(count, 1u);
}

std::vector<ProcessorCache> processor_caches(const std::string& folder) {
    std::vector<ProcessorCache> caches;
    for (int index = 0;; ++index) {
        const std::string place = fmt::format("{}/index{}/", folder, index);
        const std::string level = word_in(place + "level"), type = word_in(place + "type");
        if (level.empty()) break;
        const std::uint64_t bytes = cache_size(word_in(place + "size"));
        if (type == "Instruction" || bytes == 0) continue;
        caches.push_back({fmt::format("L{}{}", level, type == "Data" ? "d" : ""), bytes,
                          count_threads(word_in(place + "shared_cpu_list"))});
    }
    std::ranges::sort(caches, {}, &ProcessorCache::bytes);
    return caches;
}

}  // namespace raymill
