// What one core of this machine can do at most, and two at once: the bounds that kernels and threads are held against.

#include <benchmark/benchmark.h>
#include <hwy/highway.h>

#include <vector>

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Multiply-adds of single precision that do not wait for one another, in registers.
void fma_peak(benchmark::State& state) {
    const hn::ScalableTag<float> d;
    using V = decltype(hn::Zero(d));
    const V factor = hn::Set(d, 0.999F), term = hn::Set(d, 0.001F);
    V a0 = term, a1 = term, a2 = term, a3 = term, a4 = term, a5 = term, a6 = term, a7 = term, a8 = term, a9 = term;
    constexpr int rounds = 1000, chains = 10;
    for (auto _ : state) {
        for (int k = 0; k < rounds; ++k) {
            a0 = hn::MulAdd(a0, factor, term), a1 = hn::MulAdd(a1, factor, term), a2 = hn::MulAdd(a2, factor, term);
            a3 = hn::MulAdd(a3, factor, term), a4 = hn::MulAdd(a4, factor, term), a5 = hn::MulAdd(a5, factor, term);
            a6 = hn::MulAdd(a6, factor, term), a7 = hn::MulAdd(a7, factor, term), a8 = hn::MulAdd(a8, factor, term);
            a9 = hn::MulAdd(a9, factor, term);
        }
        V sum = hn::Add(hn::Add(hn::Add(a0, a1), hn::Add(a2, a3)), hn::Add(hn::Add(a4, a5), hn::Add(a6, a7)));
        sum = hn::Add(sum, hn::Add(a8, a9));
        benchmark::DoNotOptimize(hn::GetLane(hn::SumOfLanes(d, sum)));
    }
    const double flops = 2.0 * rounds * chains * static_cast<double>(hn::Lanes(d));
    state.counters["gflops"] =
        benchmark::Counter(1e-9 * flops * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
    state.counters["lanes"] = static_cast<double>(hn::Lanes(d));
}
BENCHMARK(fma_peak)->Name("machine/fma_peak")->UseRealTime()->Threads(1)->Threads(2);

// a = b + s c over arrays that no cache holds; counted are the bytes read and written.
void stream_triad(benchmark::State& state) {
    const auto n = static_cast<std::size_t>(state.range(0)) * 1024 * 1024 / sizeof(float);
    std::vector<float> a(n, 0), b(n, 1), c(n, 2);
    for (auto _ : state) {
        for (std::size_t k = 0; k < n; ++k) a[k] = b[k] + 0.5F * c[k];
        benchmark::ClobberMemory();
    }
    const double bytes = 3.0 * static_cast<double>(n * sizeof(float));
    state.counters["gb_s"] =
        benchmark::Counter(1e-9 * bytes * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(stream_triad)
    ->Name("machine/stream")
    ->Arg(128)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Threads(1)
    ->Threads(2);

}  // namespace
