#pragma once
// Domain decomposition of a model over processes, the ranks. The first rank is the server that crowds see. All ranks
// call these functions in the same order. Errors: RunError, with peer_dead if a rank has died, or the code of the
// signal that asked to stop.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace wade::fluid {

class Ranks {
 public:
    // Data sent to a neighbour and received from it; rank -1: no neighbour. Lower and upper may be the same rank.
    struct Neighbour {
        int rank = -1;
        std::span<const double> to;
        std::span<double> from;
    };

    Ranks() = default;
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;
    virtual ~Ranks() = default;

    [[nodiscard]] virtual int rank() const = 0;
    [[nodiscard]] virtual int count() const = 0;
    [[nodiscard]] bool first() const { return rank() == 0; }

    virtual void exchange(const Neighbour& lower, const Neighbour& upper) = 0;
    // The largest of what the ranks have, for all.
    [[nodiscard]] virtual double largest(double value) = 0;
    // Each word comes from one rank, the others have 0 there; for all.
    virtual void merge(std::span<std::uint64_t> words) = 0;
    // Parts of all ranks one behind the other, counts[r] words of rank r; for all, or for the first rank alone.
    virtual void gather(std::span<const std::uint64_t> part, const std::vector<int>& counts,
                        std::span<std::uint64_t> all, bool for_all) = 0;

    // What the first rank says to the others: words, or that there are no more.
    virtual void tell(std::span<const std::uint64_t> words) = 0;
    // False: there are no more.
    [[nodiscard]] virtual bool hear(std::span<std::uint64_t> words) = 0;

    // Of the first rank at its end; any code but 0 ends all ranks. The others return when it has said that there is no more.
    virtual void leave(int code) = 0;
};

// The ranks that mpirun has started, this one among them. Call once.
std::unique_ptr<Ranks> join_ranks();

}  // namespace wade::fluid
