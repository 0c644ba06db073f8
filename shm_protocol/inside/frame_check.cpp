#include "shm_protocol/inside/frame_check.hpp"

#include <cstddef>
#include <string>

#include "shm_protocol/inside/bytes/crc32c.hpp"

namespace wade::shm {
namespace {

[[noreturn]] void refuse(const StreamInfo& info, std::uint64_t frame, const std::string& why) {
    throw Error(Failure::protocol_violation,
                "Frame " + std::to_string(frame) + " from '" + info.producer_name + "' " + why + ".");
}

}  // namespace

std::string tick_fault(const StreamInfo& info, FrameTick now, bool final, const std::optional<FrameTick>& last) {
    const std::string has = "has tick " + std::to_string(now.tick);
    if (!last) return now.tick <= largest_first_tick ? "" : has + ", the first one may be 2^53 at most";
    const std::string before =
        ", frame " + std::to_string(last->frame) + " before it has " + std::to_string(last->tick);
    if (now.tick <= last->tick) return has + before;
    if (info.kind == stream_agents) return "";
    const auto frame_time = static_cast<double>(info.ticks_per_frame);
    const auto frames = static_cast<double>(now.frame - last->frame);
    const auto passed = static_cast<double>(now.tick - last->tick);
    const std::string header =
        "; at " + std::to_string(info.ticks_per_frame) + " ticks a frame, as the header says, a frame ";
    if (passed > longest_in_frames * frames * frame_time)
        return has + before + header + "lasts at most " + std::to_string(longest_in_frames) + " times as long";
    if (!final && passed * shortest_in_frames < frame_time)
        return has + before + header + "lasts at least 1/" + std::to_string(shortest_in_frames) + " as long";
    return "";
}

std::uint32_t descriptor_crc(const SlotDescriptor& descriptor) {
    SlotDescriptor copy = descriptor;
    copy.crc32c = 0;
    return crc32c(std::as_bytes(std::span(&copy, 1)).subspan(offsetof(SlotDescriptor, frame)));
}

void check_descriptor(const StreamInfo& info, std::uint64_t frame, const SlotDescriptor& d,
                      const FrameHistory& history) {
    if (history.check_descriptor && descriptor_crc(d) != d.crc32c)
        refuse(info, frame, "has a damaged descriptor: it does not match its CRC-32C");
    if (d.count > info.capacity)
        refuse(info, frame,
               "holds " + std::to_string(d.count) + " particles, the capacity is " + std::to_string(info.capacity));
}

Frame checked_frame(const StreamInfo& info, std::uint64_t frame, const SlotDescriptor& d, FieldSpans fields,
                    FrameHistory& history) {
    const FrameTick now{frame, d.tick};
    if (const std::string fault = tick_fault(info, now, (d.flags & frame_final) != 0, history.last); !fault.empty())
        refuse(info, frame, fault);
    const std::size_t required = required_fields(info.kind).size();
    ChainResult result = history.check_values ? chain_frame(history.chain, frame, fields.first(required))
                                              : ChainResult{d.hash, false, false};
    if (d.hash != 0 && d.hash != result.hash)
        refuse(info, frame,
               "does not match its hash: it was changed after it was published, or its chain is another one");
    if (info.impulses && history.check_values) {
        const ChainResult further = chain_frame(result.hash, frame, fields.subspan(required));
        if (history.check_further && d.further_hash != 0 && d.further_hash != further.hash)
            refuse(info, frame, "does not match its hash: its impulses were changed after it was published");
        result.nonfinite = result.nonfinite || further.nonfinite;
    }
    if (result.nonfinite) {
        for (std::size_t i = 0; i < fields.size(); ++i)
            if (const std::size_t k = first_nonfinite(fields[i]); k < fields[i].size())
                refuse(info, frame,
                       "holds non-finite values (first: particle " + std::to_string(k) + ", field " +
                           fields_of(info)[i] + ")");
    }
    if (result.massless) {
        const std::size_t k = first_massless(fields[0]);
        refuse(info, frame,
               "holds particles without mass (first: particle " + std::to_string(k) + " of " +
                   std::to_string(fields[0][k]) + " kg); a mass is above 0");
    }
    if ((d.flags & frame_nonfinite) != 0) refuse(info, frame, "is marked by its producer as holding non-finite values");
    history.chain = result.hash;
    history.last = now;

    Frame out;
    out.frame = frame;
    out.tick = d.tick;
    out.count = d.count;
    out.final = (d.flags & frame_final) != 0;
    out.hash = result.hash;
    out.mass = fields[0];
    out.vx = fields[1];
    out.vy = fields[2];
    out.vz = fields[3];
    out.px = fields[4];
    out.py = fields[5];
    out.pz = fields[6];
    if (info.kind == stream_agents) {
        out.radius = fields[7];
        out.height = fields[8];
        out.state = fields[9];
    }
    if (info.impulses) {
        out.jx = fields[required];
        out.jz = fields[required + 1];
        out.submerged = fields[required + 2];
        out.spread = fields[required + 3];
    }
    out.diagnostics = d.diagnostics;
    return out;
}

}  // namespace wade::shm
