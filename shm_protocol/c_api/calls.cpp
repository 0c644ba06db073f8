#include <exception>
#include <stdexcept>
#include <string>

#include "shm_protocol/c_api/columns.hpp"
#include "shm_protocol/c_api/convert.hpp"
#include "shm_protocol/c_api/wade_shm.h"
#include "shm_protocol/latest_reader.hpp"
#include "shm_protocol/publisher.hpp"
#include "shm_protocol/subscriber.hpp"

using namespace wade::shm;

struct wade_publisher {
    Publisher end;
    FrameFields slot = {};  // the last that was begun
};
struct wade_subscriber {
    Subscriber end;
    Frame frame = {};  // the last that was acquired
};
struct wade_latest {
    LatestReader end;
};

namespace {

thread_local std::string last_error;

int failed(int code, const char* text) noexcept {
    try {
        last_error = text;
    } catch (...) {
        last_error.clear();
    }
    return code;
}

// Runs the body of a call; what it throws becomes its result.
template <typename Body>
int guarded(Body&& body) noexcept {
    try {
        return body();
    } catch (const Error& error) {
        return failed(error.exit_code(), error.what());
    } catch (const std::logic_error& error) {  // std::invalid_argument is one
        return failed(WADE_USAGE, error.what());
    } catch (const std::exception& error) {
        return failed(WADE_UNEXPECTED, error.what());
    } catch (...) {
        return failed(WADE_UNEXPECTED, "unknown failure");
    }
}

template <typename... Pointers>
void demand(const char* call, const Pointers*... pointers) {
    if (((pointers == nullptr) || ...)) throw std::invalid_argument(std::string(call) + ": an argument is NULL.");
}

template <typename Handle, typename Make>
int open(const char* call, Handle** out, Make&& make) noexcept {
    return guarded([&] {
        demand(call, out);
        *out = nullptr;
        *out = new Handle{make()};
        return WADE_OK;
    });
}

// A call on a handle that gives no value.
template <typename Handle, typename Body>
int on(const char* call, Handle* handle, Body&& body) noexcept {
    return guarded([&] {
        demand(call, handle);
        body(handle->end);
        return static_cast<int>(WADE_OK);
    });
}

template <typename Handle, typename Out, typename Get>
int fetch(const char* call, Handle* handle, Out* out, int when_empty, Get&& get) noexcept {
    return guarded([&] {
        demand(call, handle, out);
        *out = Out{};
        const auto found = get(handle->end);
        if (!found) return when_empty;
        *out = c_api::to_c(*found);
        return static_cast<int>(WADE_OK);
    });
}

const char* text_or_empty(const char* text) {
    return text == nullptr ? "" : text;
}

}  // namespace

uint32_t wade_abi_version(void) {
    return WADE_ABI_VERSION;
}
const char* wade_last_error(void) {
    return last_error.c_str();
}
void wade_interrupt(void) {
    c_api::set_interrupt(true);
}
void wade_clear_interrupt(void) {
    c_api::set_interrupt(false);
}

void wade_stream_defaults(wade_stream* stream) {
    if (stream != nullptr) *stream = c_api::to_c(StreamInfo{});
}
void wade_waiting_defaults(wade_waiting* waiting) {
    const Waiting w;
    if (waiting != nullptr)
        *waiting = {w.attach_timeout_s, w.step_warning_s, w.step_timeout_s, nullptr, nullptr, nullptr};
}
void wade_join_defaults(wade_join* join) {
    if (join == nullptr) return;
    *join = {};
    join->kind = WADE_FLUID;
    wade_waiting_defaults(&join->waiting);
}
void wade_diagnostics_defaults(wade_diagnostics* diagnostics) {
    if (diagnostics != nullptr) *diagnostics = c_api::to_c(Frame{}).diagnostics;
}

int wade_publisher_open(const char* session, const wade_stream* stream, const wade_waiting* waiting,
                        wade_publisher** out) {
    return open(__func__, out, [&] {
        demand("wade_publisher_open", session, stream);
        return Publisher(session, c_api::from_c(*stream), c_api::from_c(waiting));
    });
}
int wade_publisher_open_with_impulses(const char* session, const wade_stream* stream, const wade_waiting* waiting,
                                      wade_publisher** out) {
    return open(__func__, out, [&] {
        demand("wade_publisher_open_with_impulses", session, stream);
        StreamInfo info = c_api::from_c(*stream);
        info.impulses = true;
        return Publisher(session, info, c_api::from_c(waiting));
    });
}
int wade_publisher_stream(const wade_publisher* publisher, wade_stream* out) {
    return fetch(__func__, publisher, out, WADE_OK, [](const Publisher& p) { return &p.info(); });
}
int wade_publisher_wait_for_consumers(wade_publisher* publisher, int n) {
    return on(__func__, publisher, [n](Publisher& p) { p.wait_for_consumers(n); });
}
int wade_publisher_begin_frame(wade_publisher* publisher, wade_slot* out) {
    return fetch(__func__, publisher, out, WADE_END, [publisher](Publisher& p) {
        const auto slot = p.begin_frame();
        publisher->slot = slot.value_or(FrameFields{});
        return slot;
    });
}
int wade_publisher_impulses(const wade_publisher* publisher, wade_slot_impulses* out) {
    return guarded([&] {
        demand("wade_publisher_impulses", publisher, out);
        *out = c_api::impulses_to_c(publisher->slot);
        return static_cast<int>(WADE_OK);
    });
}
int wade_publisher_end_frame(wade_publisher* publisher, uint32_t count, const wade_diagnostics* diagnostics,
                             int final) {
    return on(__func__, publisher, [&](Publisher& p) { p.end_frame(count, c_api::from_c(diagnostics), final != 0); });
}
int wade_publisher_end_frame_at(wade_publisher* publisher, uint32_t count, const wade_diagnostics* diagnostics,
                                int final, uint64_t tick) {
    return on(__func__, publisher,
              [&](Publisher& p) { p.end_frame(count, c_api::from_c(diagnostics), final != 0, tick); });
}
int wade_publisher_heartbeat(wade_publisher* publisher) {
    return on(__func__, publisher, [](Publisher& p) { p.heartbeat(); });
}
int wade_publisher_set_paused(wade_publisher* publisher, int paused) {
    return on(__func__, publisher, [paused](Publisher& p) { p.set_paused(paused != 0); });
}
int wade_columns_stream(const wade_grid* grid, wade_stream* stream) {
    return guarded([&] {
        demand("wade_columns_stream", grid, stream);
        c_api::suit_to_grid(*grid, *stream);
        return static_cast<int>(WADE_OK);
    });
}
int wade_columns(const wade_grid* grid, const wade_stream* stream, const wade_slot* slot, uint32_t* count) {
    return guarded([&] {
        demand("wade_columns", grid, stream, slot, count);
        demand("wade_columns", grid->depth, grid->u, grid->v, slot->mass);
        *count = c_api::write_columns(*grid, *stream, *slot);
        return static_cast<int>(WADE_OK);
    });
}
uint64_t wade_publisher_published_frames(const wade_publisher* publisher) {
    return publisher == nullptr ? 0 : publisher->end.published_frames();
}
uint64_t wade_publisher_frame_hash(const wade_publisher* publisher) {
    return publisher == nullptr ? 0 : publisher->end.frame_hash();
}
int wade_publisher_close(wade_publisher* publisher) {
    return on(__func__, publisher, [](Publisher& p) { p.close(); });
}
int wade_publisher_abort(wade_publisher* publisher, int reason_code, const char* text) {
    return on(__func__, publisher, [&](Publisher& p) { p.abort(reason_code, text_or_empty(text)); });
}
void wade_publisher_free(wade_publisher* publisher) {
    delete publisher;
}

int wade_subscriber_open(const char* session, const char* name, const wade_join* join, wade_subscriber** out) {
    return open(__func__, out, [&] {
        demand("wade_subscriber_open", session, name);
        return Subscriber(session, name, c_api::from_c(join));
    });
}
int wade_subscriber_refuse(const char* session, const char* name, const wade_join* join, int reason_code,
                           const char* text) {
    return guarded([&] {
        demand("wade_subscriber_refuse", session, name);
        Subscriber::refuse(session, name, c_api::from_c(join), reason_code, text_or_empty(text));
        return static_cast<int>(WADE_OK);
    });
}
int wade_subscriber_stream(const wade_subscriber* subscriber, wade_stream* out) {
    return fetch(__func__, subscriber, out, WADE_OK, [](const Subscriber& s) { return &s.info(); });
}
int wade_subscriber_acquire(wade_subscriber* subscriber, wade_frame* out) {
    return fetch(__func__, subscriber, out, WADE_END, [subscriber](Subscriber& s) {
        const auto frame = s.acquire();
        subscriber->frame = frame.value_or(Frame{});
        return frame;
    });
}
int wade_subscriber_impulses(const wade_subscriber* subscriber, wade_frame_impulses* out) {
    return guarded([&] {
        demand("wade_subscriber_impulses", subscriber, out);
        *out = c_api::impulses_to_c(subscriber->frame);
        return static_cast<int>(WADE_OK);
    });
}
int wade_subscriber_release(wade_subscriber* subscriber) {
    return on(__func__, subscriber, [](Subscriber& s) { s.release(); });
}
int wade_subscriber_heartbeat(wade_subscriber* subscriber) {
    return on(__func__, subscriber, [](Subscriber& s) { s.heartbeat(); });
}
int wade_subscriber_set_paused(wade_subscriber* subscriber, int paused) {
    return on(__func__, subscriber, [paused](Subscriber& s) { s.set_paused(paused != 0); });
}
int wade_subscriber_leave(wade_subscriber* subscriber) {
    return on(__func__, subscriber, [](Subscriber& s) { s.leave(); });
}
int wade_subscriber_abort(wade_subscriber* subscriber, int reason_code, const char* text) {
    return on(__func__, subscriber, [&](Subscriber& s) { s.abort(reason_code, text_or_empty(text)); });
}
void wade_subscriber_free(wade_subscriber* subscriber) {
    delete subscriber;
}

int wade_latest_open(const char* session, const char* name, const wade_join* join, uint32_t stride, wade_latest** out) {
    return open(__func__, out, [&] {
        demand("wade_latest_open", session, name);
        return LatestReader(session, name, c_api::from_c(join), stride);
    });
}
int wade_latest_stream(const wade_latest* reader, wade_stream* out) {
    return fetch(__func__, reader, out, WADE_OK, [](const LatestReader& r) { return &r.info(); });
}
int wade_latest_next(wade_latest* reader, wade_frame* out) {
    return fetch(__func__, reader, out, WADE_END, [](LatestReader& r) { return r.next(); });
}
int wade_latest_poll(wade_latest* reader, wade_frame* out) {
    const int result = fetch(__func__, reader, out, WADE_NOTHING_NEW, [](LatestReader& r) { return r.poll(); });
    return result == WADE_NOTHING_NEW && reader->end.ended() ? static_cast<int>(WADE_END) : result;
}
uint64_t wade_latest_dropped_frames(const wade_latest* reader) {
    return reader == nullptr ? 0 : reader->end.dropped_frames();
}
int wade_latest_leave(wade_latest* reader) {
    return on(__func__, reader, [](LatestReader& r) { r.leave(); });
}
void wade_latest_free(wade_latest* reader) {
    delete reader;
}
