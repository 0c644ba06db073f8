#include "tools/shm/observer.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "shm_protocol/inside/atomic.hpp"
#include "shm_protocol/inside/futex.hpp"
#include "shm_protocol/inside/liveness.hpp"
#include "shm_protocol/inside/pages.hpp"
#include "shm_protocol/inside/segment.hpp"

namespace wade {
namespace {

using shm::load_acquire;

class ReadOnlyMap {
 public:
    ReadOnlyMap(int fd, std::size_t bytes) : bytes_(bytes) {
        address_ = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, 0);
        if (address_ == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mapping a segment");
    }
    ~ReadOnlyMap() { ::munmap(address_, bytes_); }
    ReadOnlyMap(const ReadOnlyMap&) = delete;
    ReadOnlyMap& operator=(const ReadOnlyMap&) = delete;
    [[nodiscard]] const std::byte* base() const { return static_cast<const std::byte*>(address_); }

 private:
    void* address_;
    std::size_t bytes_;
};

double silent_s(std::uint64_t heartbeat_ns, std::int64_t now) {
    return 1e-9 * static_cast<double>(std::max(now - static_cast<std::int64_t>(heartbeat_ns), std::int64_t{0}));
}

// The newest descriptor, unless it is overwritten during each of a few tries.
std::optional<shm::SlotDescriptor> newest(const shm::Pages<const std::byte>& pages) {
    for (int i = 0; i < 8; ++i) {
        const std::uint64_t frame = load_acquire(pages.control().published_frame);
        if (frame == 0) return std::nullopt;
        const shm::SlotDescriptor& shared = pages.descriptor(frame);
        if (load_acquire(shared.sequence) != 2 * frame) continue;
        shm::SlotDescriptor copy;
        std::memcpy(&copy, &shared, sizeof copy);
        __atomic_thread_fence(__ATOMIC_ACQUIRE);
        if (shm::load_relaxed(shared.sequence) == 2 * frame && copy.frame == frame) return copy;
    }
    return std::nullopt;
}

void look_at_consumers(SegmentView& view, const shm::SegmentMap& map, const shm::Pages<const std::byte>& pages,
                       int fd) {
    for (std::uint32_t i = 0; i < map.consumer_count; ++i) {
        const shm::ConsumerEntry& entry = pages.consumer(i);
        ConsumerView c;
        c.state = load_acquire(entry.state);
        if (c.state == shm::consumer_free) continue;
        c.index = i;
        c.name = shm::printable(entry.name, shm::name_bytes);
        c.pid = entry.pid;
        c.alive = shm::is_locked_by_other(fd, shm::consumer_lock_byte + i);
        c.mode = shm::load_relaxed(entry.mode);
        c.stride = std::max(entry.stride, 1U);
        c.follows = (shm::load_relaxed(entry.flags) & shm::consumer_follows) != 0;
        c.waiting = shm::load_relaxed(entry.waiting) != 0;
        c.paused = shm::load_relaxed(entry.paused) != 0;
        c.admitted_frame = load_acquire(pages.control().admitted_frame[i]);
        c.acknowledged_frame = load_acquire(entry.acknowledged_frame);
        c.dropped_frames = shm::load_relaxed(entry.dropped_frames);
        c.silent_s = silent_s(shm::load_relaxed(entry.heartbeat_ns), view.at_ns);
        if (c.state == shm::consumer_aborted || c.state == shm::consumer_refused)
            c.reason = shm::printable(entry.reason_text, shm::reason_bytes);
        view.consumers.push_back(c);
    }
}

void look_inside(SegmentView& view, const shm::SegmentMap& map, const shm::Pages<const std::byte>& pages, int fd) {
    const shm::Control& control = pages.control();
    view.info = map.info;
    // Acknowledgements first: a consumer then never seems to be ahead of what was published.
    look_at_consumers(view, map, pages, fd);
    view.state = load_acquire(control.state);
    view.pid = control.pid;
    view.waiting = shm::load_relaxed(control.producer_waiting) != 0;
    view.paused = shm::load_relaxed(control.paused) != 0;
    view.published_frame = load_acquire(control.published_frame);
    view.silent_s = silent_s(shm::load_relaxed(control.heartbeat_ns), view.at_ns);
    if (view.state == shm::producer_aborted) {
        view.reason_code = control.reason_code;
        view.reason = shm::printable(control.reason_text, shm::reason_bytes);
    }
    view.last = newest(pages);
}

}  // namespace

namespace {

// The file if it can be looked at; else `view` says why not.
std::optional<shm::SegmentFile> open_for(SegmentView& view, const std::string& name) {
    view.condition = Condition::closed_off;
    try {
        auto file = shm::SegmentFile::open(name, shm::Access::read_only);
        if (file) return file;
        view.condition = Condition::absent;
        view.problem = "there is no such segment";
    } catch (const shm::ForeignObject&) {
        view.condition = Condition::foreign;
        view.problem = "is no plain file: " + shm::foreign_object(name);
    } catch (const std::system_error& error) {
        view.problem = "it cannot be opened: " + error.code().message();
    }
    return std::nullopt;
}

// The header page once its magic is stored.
std::optional<shm::Header> header_of(int fd) {
    const ReadOnlyMap page(fd, shm::page_bytes);
    const auto& shared = *reinterpret_cast<const shm::Header*>(page.base());
    if (load_acquire(shared.magic) == 0) return std::nullopt;
    shm::Header header;
    std::memcpy(&header, &shared, sizeof header);
    return header;
}

}  // namespace

SegmentView look_at(const std::string& name) {
    SegmentView view;
    view.name = shm::printable(name.data(), name.size());
    view.at_ns = shm::monotonic_ns();
    const auto file = open_for(view, name);
    struct stat about {};
    if (!file || ::fstat(file->fd(), &about) != 0) return view;
    view.owner = about.st_uid;
    view.mode = about.st_mode & 07777;
    view.bytes = static_cast<std::uint64_t>(about.st_size);
    view.producer_alive = shm::is_locked_by_other(file->fd(), shm::producer_lock_byte);
    view.condition = Condition::unfinished;
    view.problem = "its header is not finished";
    if (view.bytes == 0) return view;
    if (view.bytes < shm::page_bytes) {
        view.condition = Condition::refused;
        view.problem = "it is cut off: it holds " + std::to_string(view.bytes) + " bytes, its header alone 4096";
        return view;
    }
    try {
        const std::optional<shm::Header> header = header_of(file->fd());
        if (!header) return view;
        // Nothing but the header page is mapped before the header is known to be one.
        const shm::SegmentMap map = shm::read_header(*header, view.bytes);
        const ReadOnlyMap pages(file->fd(), view.bytes);
        view.condition = Condition::readable;
        view.problem.clear();
        view.version_major = header->version_major;
        view.version_minor = header->version_minor;
        look_inside(view, map, {pages.base(), map}, file->fd());
    } catch (const shm::Error& error) {
        view.condition = Condition::refused;
        view.problem = error.what();
    } catch (const std::system_error& error) {
        view.condition = Condition::refused;
        view.problem = error.what();
    }
    return view;
}

std::vector<std::string> segment_names() {
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", error)) {
        const std::string name = entry.path().filename().string();
        const auto ends_with = [&](const std::string& end) {
            return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
        };
        if (ends_with("-fluid") || ends_with("-agents")) names.push_back("/" + name);
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::uint64_t frames_behind(const SegmentView& segment, const ConsumerView& consumer) {
    if (consumer.admitted_frame == 0) return 0;
    const std::uint64_t done = std::max(consumer.acknowledged_frame, consumer.admitted_frame - 1);
    return segment.published_frame > done ? segment.published_frame - done : 0;
}

std::optional<double> frame_rate(const SegmentView& before, const SegmentView& now) {
    if (before.condition != Condition::readable || now.condition != Condition::readable ||
        before.info.session_id != now.info.session_id || now.at_ns <= before.at_ns ||
        now.published_frame < before.published_frame)
        return std::nullopt;
    return static_cast<double>(now.published_frame - before.published_frame) /
           (1e-9 * static_cast<double>(now.at_ns - before.at_ns));
}

double times_real_time(const shm::StreamInfo& info, double frames_per_s) {
    return frames_per_s * static_cast<double>(info.ticks_per_frame) / static_cast<double>(info.ticks_per_second);
}

const char* word_for(Condition condition) {
    switch (condition) {
        case Condition::absent:
            return "absent";
        case Condition::foreign:
            return "foreign";
        case Condition::closed_off:
            return "closed_off";
        case Condition::unfinished:
            return "unfinished";
        case Condition::refused:
            return "refused";
        case Condition::readable:
            return "readable";
    }
    return "";
}

std::string producer_state_word(std::uint32_t state) {
    static constexpr const char* words[] = {"init", "ready", "running", "draining", "closed", "aborted"};
    return state < std::size(words) ? words[state] : "unknown state " + std::to_string(state);
}

std::string consumer_state_word(std::uint32_t state) {
    static constexpr const char* words[] = {"free", "joined", "left", "aborted", "refused"};
    return state < std::size(words) ? words[state] : "unknown state " + std::to_string(state);
}

}  // namespace wade
