#include "fluid_server/particles/cell_pages.hpp"

namespace wade::fluid {

void CellPages::clear() {
    pages_.clear();
    std::fill(slots_.begin(), slots_.end(), none);
}

void CellPages::insert(std::uint64_t page) {
    pages_.push_back(page);
    if (2 * pages_.size() > slots_.size()) {
        slots_.resize(2 * slots_.size());
        --shift_;
        fill_slots();
        return;
    }
    std::size_t slot = slot_of(page);
    while (slots_[slot] != none) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = static_cast<std::uint32_t>(pages_.size() - 1);
}

void CellPages::settle() {
    if (std::is_sorted(pages_.begin(), pages_.end())) return;
    std::sort(pages_.begin(), pages_.end());
    fill_slots();
}

void CellPages::fill_slots() {
    std::fill(slots_.begin(), slots_.end(), none);
    for (std::size_t k = 0; k < pages_.size(); ++k) {
        std::size_t slot = slot_of(pages_[k]);
        while (slots_[slot] != none) slot = (slot + 1) & (slots_.size() - 1);
        slots_[slot] = static_cast<std::uint32_t>(k);
    }
}

}  // namespace wade::fluid
