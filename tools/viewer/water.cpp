#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "configs/errors/exit_code.hpp"
#include "shm_protocol/error.hpp"
#include "shm_protocol/latest_reader.hpp"
#include "tools/shm/observer.hpp"
#include "tools/viewer/sources.hpp"

namespace wade::view {
namespace {

constexpr double stale_after_s = 3.2;

std::int64_t now_ns() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return 1'000'000'000LL * now.tv_sec + now.tv_nsec;
}

void sleep_s(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

// What a frame and a record of a file have in common.
struct Particles {
    double frame = 0, time = 0, lasts = 0;
    std::uint32_t count = 0;
    std::span<const float> mass;
    std::array<std::span<const float>, 3> velocity, place;
};

// World coordinates in metres, every n-th particle, which stands for n.
Message water_message(const Particles& all, const shm::StreamInfo& info) {
    MessageHead head;
    head.kind = kind_water;
    head.stride = std::max(1U, (all.count + most_particles - 1) / most_particles);
    head.count = (all.count + head.stride - 1) / head.stride;
    head.fields = 7;
    head.time_s = all.time;
    head.frame = all.frame;
    head.lasts_s = static_cast<float>(all.lasts);
    Message message = new_message(head);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto stored = static_cast<std::size_t>(std::abs(info.axes[axis]) - 1);
        const auto scale = static_cast<float>(info.axes[axis] < 0 ? -info.metres_per_unit : info.metres_per_unit);
        const auto origin = static_cast<float>(info.origin[axis]);
        const auto place = array_of(message, head, axis), velocity = array_of(message, head, 3 + axis);
        for (std::size_t i = 0; i < head.count; ++i) {
            place[i] = origin + scale * all.place[stored][i * head.stride];
            velocity[i] = scale * all.velocity[stored][i * head.stride];
        }
    }
    const double density = info.rest_density > 0 ? info.rest_density : 1000;
    const auto volume = array_of(message, head, 6);
    for (std::size_t i = 0; i < head.count; ++i) {
        volume[i] = static_cast<float>(head.stride / density) * all.mass[i * head.stride];
    }
    return message;
}

Message walkers_message(const shm::Frame& frame, double time) {
    MessageHead head;
    head.kind = kind_walkers;
    head.count = frame.count;
    head.fields = 7;
    head.time_s = time;
    head.frame = static_cast<double>(frame.frame);
    Message message = new_message(head);
    for (std::size_t id = 0; id < frame.count; ++id) array_of(message, head, 0)[id] = static_cast<float>(id);
    const std::array fields{frame.px, frame.pz, frame.vx, frame.vz, frame.height, frame.state};
    for (std::size_t f = 0; f < fields.size(); ++f) {
        std::copy(fields[f].begin(), fields[f].end(), array_of(message, head, 1 + f).begin());
    }
    return message;
}

double seconds_of(std::uint64_t tick, const shm::StreamInfo& info) {
    return static_cast<double>(tick) / static_cast<double>(info.ticks_per_second);
}

}  // namespace

LiveStream::LiveStream(std::string session, shm::StreamKind kind)
    : session_(std::move(session)), kind_(kind), thread_([this] { read_all(); }) {}

LiveStream::~LiveStream() {
    stop_ = true;
    thread_.join();
}

bool LiveStream::is_wanted() const {
    return now_ns() - wanted_at_ns_ < 2'000'000'000LL;
}

Message LiveStream::newest() {
    wanted_at_ns_ = now_ns();
    const std::lock_guard lock(mutex_);
    return newest_;
}

std::string LiveStream::problem() {
    const std::lock_guard lock(mutex_);
    return problem_;
}

std::string LiveStream::state() {
    if (const char* end = end_) return end;
    const SegmentView view = look_at(shm::segment_name(session_, kind_));
    if (view.condition != Condition::readable || !view.producer_alive) {
        return came_at_ns_ == 0                                                             ? "waiting"
               : view.condition == Condition::readable && view.state < shm::producer_closed ? "killed"
                                                                                            : "ended";
    }
    const bool consumer_pauses = std::any_of(view.consumers.begin(), view.consumers.end(),
                                             [](const ConsumerView& c) { return c.alive && c.paused; });
    if (view.paused || consumer_pauses) return "paused";
    if (view.published_frame == 0) return "waiting";
    const bool is_old = is_wanted() && 1e-9 * static_cast<double>(now_ns() - came_at_ns_) > stale_after_s;
    return is_old && came_at_ns_ != 0 ? "stale" : "running";
}

double LiveStream::passed_s() {
    const SegmentView view = look_at(shm::segment_name(session_, kind_));
    if (view.condition != Condition::readable) return passed_s_;
    if (view.published_frame < next_frame_) next_frame_ = 0, passed_s_ = 0;  // a new stream of this name
    const auto crowd = std::find_if(view.consumers.begin(), view.consumers.end(),
                                    [](const ConsumerView& c) { return c.alive && c.name == "crowd"; });
    // In LATEST mode a frame is acknowledged as it is taken, and done once a newer one is taken.
    const bool is_done = crowd == view.consumers.end() ||
                         crowd->acknowledged_frame >= next_frame_ + (crowd->mode == shm::mode_latest ? 1 : 0);
    if (next_frame_ > 0 && is_done) {
        passed_s_ = next_s_;
        next_frame_ = 0;
    }
    if (next_frame_ == 0 && view.last) {
        next_frame_ = view.last->frame;
        next_s_ = seconds_of(view.last->tick, view.info);
    }
    return passed_s_;
}

void LiveStream::keep(Message message) {
    came_at_ns_ = now_ns();
    const std::lock_guard lock(mutex_);
    newest_ = std::move(message);
    problem_.clear();
}

// Waits for a producer, reads its stream, and waits for the next one of that name.
void LiveStream::read_all() {
    while (!stop_) {
        const SegmentView view = look_at(shm::segment_name(session_, kind_));
        if (view.condition == Condition::readable && view.producer_alive && view.state < shm::producer_closed) {
            try {
                end_ = nullptr;
                read_stream();
                end_ = "ended";
            } catch (const std::exception& error) {
                const auto* failure = dynamic_cast<const shm::Error*>(&error);
                const bool has_died = failure != nullptr && failure->failure() == shm::Failure::peer_dead;
                if (came_at_ns_ != 0) end_ = has_died ? "killed" : "ended";
                const std::lock_guard lock(mutex_);
                problem_ = error.what();
            }
        }
        for (int i = 0; i < 10 && !stop_; ++i) sleep_s(0.02);
    }
}

void LiveStream::read_stream() {
    shm::JoinOptions join;
    join.kind = kind_;
    join.check_values = false;  // the crowd does
    join.waiting.attach_timeout_s = 0;
    join.waiting.step_timeout_s = 0;
    join.waiting.step_warning_s = 0;
    join.waiting.interrupted = [this] { return stop_.load(); };
    shm::LatestReader reader(session_, "viewer", join);
    const shm::StreamInfo& info = reader.info();
    for (std::int64_t last = 0; !stop_;) {
        const double since = 1e-9 * static_cast<double>(now_ns() - last);
        if (since < 1 / most_frames_per_s) sleep_s(1 / most_frames_per_s - since);
        if (!is_wanted() && came_at_ns_ != 0) {  // no client looks: not even a copy
            if (!reader.producer_is_there()) return;
            sleep_s(0.05);
            continue;
        }
        const std::optional<shm::Frame> frame = reader.next();
        if (!frame) return;
        last = now_ns();
        const double time = seconds_of(frame->tick, info);
        if (kind_ == shm::stream_agents) {
            keep(walkers_message(*frame, time));
        } else {
            keep(water_message({static_cast<double>(frame->frame),
                                time,
                                0,
                                frame->count,
                                frame->mass,
                                {frame->vx, frame->vy, frame->vz},
                                {frame->px, frame->py, frame->pz}},
                               info));
        }
    }
}

RecordedWater::RecordedWater(const std::filesystem::path& file) : recording_(file) {
    if (recording_.info().kind != shm::stream_fluid)
        throw ConfigurationError(file.string() + " holds agents; the viewer shows recordings of water.");
    if (recording_.frames().empty()) throw ConfigurationError(file.string() + " holds no whole frame.");
    std::uint32_t most = 0;
    for (const auto& record : recording_.frames()) most = std::max(most, record.descriptor.count);
    arrays_.assign(7, std::vector<float>(most));
}

double RecordedWater::time_of(const recording::FrameRecord& record) const {
    return seconds_of(record.descriptor.tick, recording_.info());
}

double RecordedWater::first_s() const {
    return time_of(recording_.frames().front());
}

double RecordedWater::last_s() const {
    return time_of(recording_.frames().back());
}

Message RecordedWater::at(double time_s) {
    const auto& frames = recording_.frames();
    const auto after = std::upper_bound(frames.begin(), frames.end(), time_s + 1e-6,
                                        [this](double t, const auto& record) { return t < time_of(record); });
    const recording::FrameRecord& record = after == frames.begin() ? frames.front() : *std::prev(after);
    const auto number = static_cast<double>(record.descriptor.frame);
    if (last_ && last_frame_ == number) return last_;
    shm::FrameFields slot;
    const std::array to{&slot.mass, &slot.vx, &slot.vy, &slot.vz, &slot.px, &slot.py, &slot.pz};
    for (std::size_t i = 0; i < to.size(); ++i) *to[i] = arrays_[i];
    recording_.read(record, slot);
    const auto next = after == frames.begin() ? frames.begin() + 1 : after;
    last_ = water_message({number,
                           time_of(record),
                           next == frames.end() ? 0 : time_of(*next) - time_of(record),
                           record.descriptor.count,
                           slot.mass,
                           {slot.vx, slot.vy, slot.vz},
                           {slot.px, slot.py, slot.pz}},
                          recording_.info());
    last_frame_ = number;
    return last_;
}

}  // namespace wade::view
