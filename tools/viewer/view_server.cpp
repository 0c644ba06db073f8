// wade_view_server: the page of tools/wade view and what it shows, on 127.0.0.1 alone.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "configs/files/plain_file.hpp"
#include "configs/json/json.hpp"
#include "configs/loading/scene_loader.hpp"
#include "configs/program/program.hpp"
#include "configs/program/run_control.hpp"
#include "tools/shm/tool_arguments.hpp"
#include "tools/viewer/sources.hpp"
#include "tools/viewer/web_server.hpp"

namespace {

using namespace wade;
using namespace wade::view;
namespace fs = std::filesystem;

struct Options {
    std::string page, three, run, recording, session, scene, commands;
    double port = 0;
    bool starts = false;
};

// The text of a file, of at most 64 MiB.
std::string content_of(const fs::path& file) {
    constexpr std::uint64_t most = std::uint64_t{64} << 20;
    const PlainFile plain(file);
    std::string text(std::min(plain.bytes(), most), '\0');
    text.resize(plain.read(0, text.data(), text.size()));
    return text;
}

// All that can be asked for, by path: a request never becomes a name of the file system.
std::map<std::string, fs::path> files_of(const Options& o) {
    std::map<std::string, fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(o.page, error)) {
        const std::string ending = entry.path().extension();
        if (ending == ".js" || ending == ".html") files["/" / entry.path().filename()] = entry.path();
    }
    if (!files.contains("/index.html"))
        throw ConfigurationError("--page " + o.page + ": there is no index.html in it.");
    files["/"] = files["/index.html"];
    const std::array three{"build/three.module.js", "build/three.core.js", "examples/jsm/controls/OrbitControls.js"};
    for (const char* name : three) {
        const fs::path file = fs::path(o.three) / name;
        if (!fs::exists(file)) throw ConfigurationError("--three " + o.three + ": there is no " + name + " in it.");
        files["/three/" + file.filename().string()] = file;
    }
    return files;
}

std::string type_of(const fs::path& file) {
    return file.extension() == ".html" ? "text/html; charset=utf-8" : "text/javascript; charset=utf-8";
}

Json list_of(const auto& words) {
    return Json(std::vector<std::string>(std::begin(words), std::end(words)));
}

// Null for a text that is not JSON.
Json parsed(const std::string& text) {
    return Json::try_parse(text).value_or(Json());
}

std::string text_of(const Json& value) {
    return value.dump({.sorted = true, .lossy_text = true});
}

std::optional<Answer> answer_with(Message message) {
    if (!message) return std::nullopt;
    return Answer{true, std::move(message)};
}

std::optional<Answer> answer_with(const Json& value) {
    return Answer{false, std::make_shared<std::string>(text_of(value))};
}

// A command of the page becomes a line of the FIFO of the crowd, which takes it between two frames and records it.
std::string pass_on(const std::string& command, const std::string& fifo) {
    if (std::any_of(command.begin(), command.end(), [](unsigned char c) { return c < ' '; })) return "one line, please";
    if (fifo.empty()) return "this run takes no commands; start it with --view or --commands FIFO";
    try {
        const Command known = parse_command(command);
        if (known.kind == Command::Kind::quit) return "quit is not for the page";
    } catch (const std::exception& error) {
        return error.what();
    }
    const int fd = ::open(fifo.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat kind {};
    if (fd < 0 || ::fstat(fd, &kind) != 0 || !S_ISFIFO(kind.st_mode)) {
        if (fd >= 0) ::close(fd);
        return "the crowd does not listen any more";
    }
    const std::string line = command + "\n";
    const bool written = ::write(fd, line.data(), line.size()) == static_cast<ssize_t>(line.size());
    ::close(fd);
    return written ? "" : "the crowd does not listen";
}

class Show {
 public:
    explicit Show(const Options& o) : options_(o), files_(files_of(o)) {
        if (!o.run.empty()) folder_.emplace(o.run, o.starts);
        if (!o.recording.empty()) recorded_.emplace(o.recording);
        if (!o.session.empty()) {
            live_.emplace(o.session, shm::stream_fluid);
            walkers_.emplace(o.session, shm::stream_agents);
        }
    }

    [[nodiscard]] std::optional<WebFile> file(const std::string& path) {
        if (path == "/run.json") return WebFile{"application/json", text_of(description())};
        const auto found = files_.find(path);
        if (found == files_.end()) return std::nullopt;
        return WebFile{type_of(found->second), content_of(found->second)};
    }

    [[nodiscard]] static std::optional<Question> understand(const std::string& text) {
        const Json asked = parsed(text);
        if (!asked["get"].is_string()) return std::nullopt;
        Question question;
        question.kind = asked["get"].get<std::string>();
        const std::array kinds{"live",  "walkers", "water",   "depths",  "people", "paths",
                               "terms", "course",  "command", "changes", "ground"};
        if (std::find(kinds.begin(), kinds.end(), question.kind) == kinds.end()) return std::nullopt;
        const auto number = [&](const char* name, double otherwise) {
            const double value = asked[name].is_number() ? asked[name].get<double>() : otherwise;
            return std::isfinite(value) ? std::clamp(value, -1.0, 1e9) : otherwise;
        };
        question.time = number("t", 0);
        question.after = number("after", -1);
        question.id = static_cast<std::uint32_t>(std::max(0.0, number("id", 0)));
        question.slot = static_cast<std::uint32_t>(std::clamp(number("slot", 0), 0.0, 15.0));
        if (asked["line"].is_string()) question.command = asked["line"].get<std::string>();
        return question;
    }

    [[nodiscard]] std::optional<Answer> answer(const Question& q) {
        if (q.kind == "live" || q.kind == "walkers") {
            std::optional<LiveStream>& stream = q.kind == "live" ? live_ : walkers_;
            if (!stream) return std::nullopt;
            const Message newest = stream->newest();
            return newest && frame_of(newest) > q.after ? answer_with(newest) : std::nullopt;
        }
        if (q.kind == "water") return recorded_ ? recorded_water(q.time) : std::nullopt;
        if (q.kind == "command") {
            const std::string problem = pass_on(q.command, options_.commands);
            return answer_with(Json{{"command", q.command}, {"problem", problem}});
        }
        if (q.kind == "ground") return ground_ ? answer_with(ground_) : std::nullopt;
        if (!folder_) return std::nullopt;
        if (q.kind == "depths") return answer_with(folder_->depths(q.time));
        if (q.kind == "people") return answer_with(folder_->people(static_cast<std::size_t>(std::max(0.0, q.after))));
        if (q.kind == "paths") return answer_with(folder_->paths(q.time));
        if (q.kind == "terms")
            return answer_with(Json{{"terms", folder_->terms(q.id, q.time)}, {"id", q.id}, {"t", q.time}});
        if (q.kind == "course") return answer_with(Json{{"course", folder_->course(q.id)}, {"id", q.id}});
        return answer_with(Json{{"changes", changes(static_cast<std::size_t>(std::max(0.0, q.after)))}});
    }

    [[nodiscard]] std::string status() {
        Json s;
        s["live"] = live_ ? Json{{"state", live_->state()}, {"problem", live_->problem()}} : Json();
        const bool walks = walkers_ && walkers_->newest() != nullptr;
        s["walkers"] = walks;
        if (recorded_)
            s["recorded"] = {{"first", recorded_->first_s()},
                             {"last", recorded_->last_s()},
                             {"frames", recorded_->frames()},
                             {"whole", recorded_->is_whole()}};
        if (folder_) {
            const std::size_t people = folder_->people_frames(), depths = folder_->snapshots();
            s["people"] = {{"frames", people},
                           {"last", people > 0 ? folder_->people_time(people - 1) : 0},
                           {"rate", people > 1 ? 1 / (folder_->people_time(1) - folder_->people_time(0)) : 1},
                           {"poses", folder_->has_poses()}};
            s["depths"] = {{"frames", depths},
                           {"last", depths > 0 ? folder_->snapshot_time(depths - 1) : 0},
                           {"problem", folder_->water_problem()}};
            s["changes"] = folder_->changes().size();
            const Json outcome = parsed(folder_->text_of("outcome.json"));
            s["outcome"] = outcome.contains("status") ? outcome["status"] : "";
            s["events"] = folder_->text_of("events.jsonl");
        }
        return text_of(Json{{"status", s}});
    }

    bool work() {
        if (folder_ && ++ticks_ % (has_more_ ? 1 : 8) == 0) {
            const double passed_s = live_ ? live_->passed_s() : 0;  // before the files are read
            has_more_ = folder_->read_on(passed_s);
        }
        return received_signal() == 0;
    }

 private:
    // A frame that is damaged is told, and the last good one stays.
    [[nodiscard]] std::optional<Answer> recorded_water(double time) {
        try {
            return answer_with(recorded_->at(time));
        } catch (const std::exception& error) {
            return answer_with(Json{{"error", error.what()}, {"water", time}});
        }
    }

    static double frame_of(const Message& message) {
        MessageHead head;
        std::memcpy(&head, message->data(), sizeof head);
        return head.frame;
    }

    [[nodiscard]] Json changes(std::size_t from) const {
        constexpr std::size_t most = 20000;
        Json list = Json::array();
        const auto& all = folder_->changes();
        for (std::size_t k = from; k < all.size() && k < from + most; ++k) {
            const int state = all[k].state;
            list.push_back({all[k].time, all[k].id, state < 0 ? unknown_word : state_words[state]});
        }
        return list;
    }

    // What stays as it is, and the small files as they are now.
    [[nodiscard]] Json description() {
        Json d{{"states", list_of(state_words)},
               {"ends", list_of(state_ends)},
               {"postures", list_of(posture_words)},
               {"fields", list_of(people_fields)}};
        d["commands"] = !options_.commands.empty();
        d["name"] = fs::path(options_.run.empty() ? options_.recording.empty() ? options_.session : options_.recording
                                                  : options_.run)
                        .lexically_normal()
                        .filename()
                        .string();
        if (!options_.scene.empty()) d["scene"] = content_of(options_.scene);
        if (folder_)
            for (const char* name : {"manifest.json", "outcome.json", "agents.csv"})
                d["files"][name] = folder_->text_of(name);
        if (site_.is_null()) read_site(d);
        if (!site_.is_null()) d["site"] = site_;
        return d;
    }

    // The site of the scene, from the files that it names, which may be gone by now: then the page says so.
    void read_site(const Json& d) {
        const auto in_text = [](const Json& text) {
            return text.is_string() ? parsed(text.get<std::string>()) : Json();
        };
        const Json scene = in_text(d["scene"]), manifest = in_text(d["files"]["manifest.json"]);
        const Json& known = scene.is_object() ? scene : manifest["resolved_scene"];
        if (!known.contains("site") && !known.contains("place")) return;  // /place in older runs
        try {
            const Scene read = load_scene_text(text_of(known), "manifest.json").scene;
            if (!read.site) return;
            site_ = Json::parse(site_json(*read.site));
            ground_ = ground_of(read);
        } catch (const std::exception& error) {
            site_ = Json{{"problem", error.what()}};
        }
    }

    Options options_;
    std::map<std::string, fs::path> files_;
    std::optional<RunFolder> folder_;
    std::optional<RecordedWater> recorded_;
    std::optional<LiveStream> live_, walkers_;
    Json site_;
    Message ground_;
    bool has_more_ = true;
    unsigned ticks_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    Options o;
    ToolArguments arguments("wade_view_server",
                            "Serves the page of tools/wade view, and what it shows, on 127.0.0.1. Holds up no run.");
    arguments.word("--page", o.page, "Folder of the page", {"DIR"});
    arguments.word("--three", o.three, "Folder of the npm package three", {"DIR"});
    arguments.word("--run", o.run, "Run folder to show", {"DIR"});
    arguments.word("--recording", o.recording, "Recording of the water to show", {"FILE"});
    arguments.word("--session", o.session, "Session to show live", {"NAME"});
    arguments.word("--scene", o.scene, "Resolved scene, until the run folder has a manifest", {"FILE"});
    arguments.word("--commands", o.commands, "FIFO of the crowd's commands: tau, pause, step", {"FIFO"});
    arguments.number("--port", o.port, "Port; 0: any that is free", "N", {0, 65535}, Whole::yes);
    arguments.flag("--starts", o.starts, "The run is about to start: its folder may be empty");
    return run_tool(arguments, argc, argv, [&](Console&) {
        if (o.run.empty() && o.recording.empty() && o.session.empty())
            throw ConfigurationError("nothing to show; give --run, --recording or --session.");
        catch_signals();
        Show show(o);
        Pages site;
        site.file = [&](const std::string& path) { return show.file(path); };
        site.understand = [](const std::string& text) { return Show::understand(text); };
        site.answer = [&](const Question& question) { return show.answer(question); };
        site.status = [&] { return show.status(); };
        site.work = [&] { return show.work(); };
        serve(static_cast<std::uint16_t>(o.port), site,
              [](const std::string& address) { std::cout << address << std::endl; });
        return 0;
    });
}
