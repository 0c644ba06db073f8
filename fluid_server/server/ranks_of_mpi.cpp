// Ranks by MPI (Message Passing Interface Forum, MPI 3.1, 2015). Nothing waits within MPI, where no signal could end it: each
// call is begun, and then asked after.

#include <mpi.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>

#include "configs/errors/exit_code.hpp"
#include "configs/program/program.hpp"
#include "fluid_server/ranks.hpp"

namespace wade::fluid {

namespace {

constexpr int downwards = 1, upwards = 2;  // tags
constexpr int most_words = 8;              // that the first rank says at once

// Returns whether a process of this machine has ended. An ended process stays listed, as a zombie, until its parent
// waits for it.
bool has_ended(std::uint64_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    std::string text;
    std::getline(file, text);
    const std::size_t name_end = text.rfind(')');
    return name_end == std::string::npos || text.substr(name_end, 3) == ") Z" || text.substr(name_end, 3) == ") X";
}

class MpiRanks final : public Ranks {
 public:
    MpiRanks() {
        int provided = 0;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &count_);
        int size = 0;
        std::array<char, MPI_MAX_PROCESSOR_NAME> name{};
        MPI_Get_processor_name(name.data(), &size);
        const std::array<std::uint64_t, 2> own{
            std::hash<std::string>{}(std::string(name.data(), static_cast<std::size_t>(size))),
            static_cast<std::uint64_t>(::getpid())};
        processes_.resize(2 * static_cast<std::size_t>(count_));
        gather(own, std::vector<int>(static_cast<std::size_t>(count_), 2), processes_, true);
    }

    [[nodiscard]] int rank() const override { return rank_; }
    [[nodiscard]] int count() const override { return count_; }

    void exchange(const Neighbour& lower, const Neighbour& upper) override {
        std::array<MPI_Request, 4> requests{};
        std::size_t n = 0;
        const auto begin = [&](const Neighbour& side, int to, int from) {
            if (side.rank < 0) return;
            MPI_Irecv(side.from.data(), static_cast<int>(side.from.size()), MPI_DOUBLE, side.rank, from, MPI_COMM_WORLD,
                      &requests[n++]);
            MPI_Isend(side.to.data(), static_cast<int>(side.to.size()), MPI_DOUBLE, side.rank, to, MPI_COMM_WORLD,
                      &requests[n++]);
        };
        begin(lower, downwards, upwards);
        begin(upper, upwards, downwards);
        wait({requests.data(), n});
    }
    [[nodiscard]] double largest(double value) override {
        double most = 0;
        MPI_Request request{};
        MPI_Iallreduce(&value, &most, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD, &request);
        wait({&request, 1});
        return most;
    }
    void merge(std::span<std::uint64_t> words) override {
        MPI_Request request{};
        MPI_Iallreduce(MPI_IN_PLACE, words.data(), static_cast<int>(words.size()), MPI_UINT64_T, MPI_BOR,
                       MPI_COMM_WORLD, &request);
        wait({&request, 1});
    }
    void gather(std::span<const std::uint64_t> part, const std::vector<int>& counts, std::span<std::uint64_t> all,
                bool for_all) override {
        std::vector<int> places(counts.size(), 0);
        for (std::size_t r = 1; r < counts.size(); ++r) places[r] = places[r - 1] + counts[r - 1];
        const int size = static_cast<int>(part.size());
        MPI_Request request{};
        if (for_all) {
            MPI_Iallgatherv(part.data(), size, MPI_UINT64_T, all.data(), counts.data(), places.data(), MPI_UINT64_T,
                            MPI_COMM_WORLD, &request);
        } else {
            MPI_Igatherv(part.data(), size, MPI_UINT64_T, all.data(), counts.data(), places.data(), MPI_UINT64_T, 0,
                         MPI_COMM_WORLD, &request);
        }
        wait({&request, 1});
    }

    void tell(std::span<const std::uint64_t> words) override {
        std::array<std::uint64_t, most_words> said{words.size()};
        std::copy(words.begin(), words.end(), said.begin() + 1);
        pass_on(said);
    }
    [[nodiscard]] bool hear(std::span<std::uint64_t> words) override {
        std::array<std::uint64_t, most_words> said{};
        pass_on(said);
        std::copy_n(said.begin() + 1, said[0], words.begin());
        return said[0] > 0;
    }

    void leave(int code) override {
        if (code != 0) MPI_Abort(MPI_COMM_WORLD, code);
        if (first()) tell({});
        MPI_Finalize();
    }

 private:
    void pass_on(std::array<std::uint64_t, most_words>& said) {
        MPI_Request request{};
        MPI_Ibcast(said.data(), most_words, MPI_UINT64_T, 0, MPI_COMM_WORLD, &request);
        wait({&request, 1});
    }

    // Whoever waits long lets others work: ranks may share processors, and a crowd may pause.
    void wait(std::span<MPI_Request> requests) const {
        using namespace std::chrono;
        const auto begin = steady_clock::now();
        for (int tried = 0;; ++tried) {
            int done = 0;
            MPI_Testall(static_cast<int>(requests.size()), requests.data(), &done, MPI_STATUSES_IGNORE);
            if (done != 0) return;
            if (received_signal() != 0) throw_why();
            if (tried < 1000) {
                ::sched_yield();
            } else {
                const auto waited = duration_cast<microseconds>(steady_clock::now() - begin);
                std::this_thread::sleep_for(std::min(waited / 10, microseconds(1000)));
            }
        }
    }

    // mpirun asks all to end when one has died.
    [[noreturn]] void throw_why() const {
        const auto own = static_cast<std::size_t>(2 * rank_);
        for (std::size_t r = 0; r < processes_.size(); r += 2) {
            if (processes_[r] != processes_[own] || !has_ended(processes_[r + 1])) continue;
            throw RunError(ExitCode::peer_dead, "rank " + std::to_string(r / 2) + " of " + std::to_string(count_) +
                                                    " (process " + std::to_string(processes_[r + 1]) + ") has died");
        }
        throw RunError(static_cast<ExitCode>(exit_code_of_signal()),
                       "interrupted by a signal, or a rank elsewhere died");
    }

    int rank_ = 0, count_ = 1;
    std::vector<std::uint64_t> processes_;  // machine and number, by rank
};

}  // namespace

std::unique_ptr<Ranks> join_ranks() {
    return std::make_unique<MpiRanks>();
}

}  // namespace wade::fluid
