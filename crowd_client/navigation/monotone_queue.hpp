#pragma once
// A priority queue for keys that never fall below the last one taken out.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace wade::crowd {

// Radix heap after Ahuja, Mehlhorn, Orlin and Tarjan 1990 ("Faster algorithms for the shortest path problem"): an entry moves at
// most once per bit, in place of log n comparisons. Entries leave in the order of (time, node), as from a binary heap of pairs.
class MonotoneQueue {
 public:
    void clear() {
        for (auto& bucket : buckets_) bucket.clear();
        last_ = 0;
        size_ = 0;
    }

    [[nodiscard]] bool empty() const { return size_ == 0; }

    // Adds a node. time: s, at least that of the entry taken out last, and at least 0.
    void push(double time, std::uint32_t node) {
        add({std::bit_cast<std::uint64_t>(time), node});
        ++size_;
    }

    // Takes out the node of the least time; of equal times the least node.
    std::uint32_t pop() {
        if (buckets_[0].empty()) refill();
        const std::uint32_t node = buckets_[0].back().second;
        buckets_[0].pop_back();
        --size_;
        return node;
    }

 private:
    using Entry = std::pair<std::uint64_t, std::uint32_t>;  // bits of a time, which are ordered as times are; node

    // Bucket 0 holds the times equal to last_, the least node at its end; bucket b those with b - 1 as the highest different bit.
    void add(const Entry& entry) {
        std::vector<Entry>& bucket = buckets_[static_cast<std::size_t>(std::bit_width(entry.first ^ last_))];
        if (&bucket != buckets_.data()) {
            bucket.push_back(entry);
        } else {
            bucket.insert(std::lower_bound(bucket.begin(), bucket.end(), entry, std::greater<>{}), entry);
        }
    }

    void refill() {
        const auto full = std::find_if(buckets_.begin(), buckets_.end(),
                                       [](const std::vector<Entry>& bucket) { return !bucket.empty(); });
        last_ = std::min_element(full->begin(), full->end())->first;
        for (const Entry& entry : *full) {
            buckets_[static_cast<std::size_t>(std::bit_width(entry.first ^ last_))].push_back(entry);
        }
        full->clear();
        std::sort(buckets_[0].begin(), buckets_[0].end(), std::greater<>{});
    }

    std::array<std::vector<Entry>, 65> buckets_;
    std::uint64_t last_ = 0;
    std::size_t size_ = 0;
};

}  // namespace wade::crowd
