#pragma once
// Atomic access to words of a segment by the compiler's built-ins. The words are plain integers of a C layout in memory
// that may be mapped read-only, and C++20 has no std::atomic_ref<const T>.

#include <cstdint>

namespace wade::shm {

static_assert(__atomic_always_lock_free(sizeof(std::uint64_t), nullptr) &&
              __atomic_always_lock_free(sizeof(std::uint32_t), nullptr));

template <typename T>
[[nodiscard]] inline T load_relaxed(const T& word) {
    return __atomic_load_n(&word, __ATOMIC_RELAXED);
}
template <typename T>
[[nodiscard]] inline T load_acquire(const T& word) {
    return __atomic_load_n(&word, __ATOMIC_ACQUIRE);
}
template <typename T>
[[nodiscard]] inline T load_ordered(const T& word) {  // sequentially consistent
    return __atomic_load_n(&word, __ATOMIC_SEQ_CST);
}
template <typename T>
inline void store_relaxed(T& word, T value) {
    __atomic_store_n(&word, value, __ATOMIC_RELAXED);
}
template <typename T>
inline void store_release(T& word, T value) {
    __atomic_store_n(&word, value, __ATOMIC_RELEASE);
}
template <typename T>
inline void store_ordered(T& word, T value) {  // sequentially consistent
    __atomic_store_n(&word, value, __ATOMIC_SEQ_CST);
}
// Fences for readers that do not wait (LATEST mode): what a writer stores before its payload is visible before it, what
// a reader loads after its payload is loaded after it. ThreadSanitizer models no fences.
inline void fence_release() {
#ifndef __SANITIZE_THREAD__
    __atomic_thread_fence(__ATOMIC_RELEASE);
#endif
}
inline void fence_acquire() {
#ifndef __SANITIZE_THREAD__
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
#endif
}
inline void count_up(std::uint32_t& word) {  // sequentially consistent
    __atomic_fetch_add(&word, 1U, __ATOMIC_SEQ_CST);
}

}  // namespace wade::shm
