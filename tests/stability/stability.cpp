// Runs one hard case, says whether it holds, and writes a JSON file about it.

#include <omp.h>

#include <charconv>
#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>

#include "configs/errors/exit_code.hpp"
#include "record.hpp"

using namespace wade;
using namespace wade::stability;

namespace {

constexpr const char* help = R"(Usage: stability --list | --case NAME [options]

Runs one hard case of the fluid and the crowd and prints what was measured. Exit code 0: all rules hold but for known
failures (known_failures.csv), 1: one does not, 2: bad usage or scene.

  --list                names and troubles of all cases
  --case NAME           the case
  --quick, --long       its small form, or its long one where it has one
  --setting NAME        name of the solver settings, for the record [default]
  --set /pointer=value  a value of the case's scenes, repeatable
  --threads N           threads of the solver, 1 to 256 [1]
  --compare-threads N   runs it again with so many threads: the bits must be equal
  --out DIR             writes DIR/CASE-SETTING.json
  --fingerprint TEXT    copied into that file
)";

struct Arguments {
    std::string name;
    Run run;
    int compare_threads = 0;
    bool list = false, wants_help = false;
    std::optional<std::filesystem::path> out;
};

int thread_number(const std::string& option, const std::string& text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < 1 || value > 256) {
        throw ConfigurationError(option + " " + text + ": allowed are 1 to 256");
    }
    return value;
}

Arguments parse(int argc, char** argv) {
    Arguments a;
    for (int i = 1; i < argc; ++i) {
        const std::string option = argv[i];
        const auto value = [&]() -> std::string {
            if (i + 1 >= argc) throw ConfigurationError(option + " needs a value");
            return argv[++i];
        };
        if (option == "--list")
            a.list = true;
        else if (option == "--help" || option == "-h")
            a.wants_help = true;
        else if (option == "--case")
            a.name = value();
        else if (option == "--quick")
            a.run.quick = true;
        else if (option == "--long")
            a.run.long_form = true;
        else if (option == "--setting")
            a.run.setting = value();
        else if (option == "--set")
            a.run.overrides.push_back(value());
        else if (option == "--threads")
            a.run.threads = thread_number(option, value());
        else if (option == "--compare-threads")
            a.compare_threads = thread_number(option, value());
        else if (option == "--fingerprint")
            a.run.fingerprint = value();
        else if (option == "--out")
            a.out = value();
        else
            throw ConfigurationError("unknown option " + option + "; see --help");
    }
    return a;
}

const Case& find_case(const std::string& name) {
    for (const Case& c : all_cases()) {
        if (c.name == name) return c;
    }
    throw ConfigurationError("--case '" + name + "' is none of those that --list prints");
}

void print(const Case& c, const Run& run, const Result& r, const std::vector<KnownFailure>& known) {
    std::cout << c.name << " (" << run.setting << "): " << verdict(c, run, r, known) << "; " << r.particles
              << " particles, " << r.steps << " steps, largest compression of a particle " << 100 * r.max_density_error
              << " %, " << r.cpu_time << " s CPU\n";
    for (const Check& check : all_checks(r)) {
        std::cout << "  " << check.name << " = " << check.value;
        const bool is_judged = check.rule != Check::Rule::report;
        if (is_judged) std::cout << ", must be " << check.rule_text();
        if (!check.passes()) std::cout << (is_known(known, c.name, run.setting, check) ? ": known failure" : ": FAIL");
        std::cout << '\n';
    }
    for (const std::string& remark : r.remarks) std::cout << "  " << remark << '\n';
    if (!r.failure.empty()) std::cout << "  given up: " << r.failure << '\n';
}

int run_case(const Arguments& a) {
    const Case& c = find_case(a.name);
    const std::vector<KnownFailure> known = read_known_failures(WADE_KNOWN_FAILURES);
    const Request request{a.run.overrides, a.run.quick, a.run.long_form};
    omp_set_num_threads(a.run.threads);
    Result result = c.run(request);
    if (a.compare_threads > 0) {
        omp_set_num_threads(a.compare_threads);
        const Result other = c.run(request);
        check_at_most(result, "bits_differ_between_threads", other.state_hash == result.state_hash ? 0 : 1, 0);
    }
    print(c, a.run, result, known);
    if (a.out) {
        write_record(*a.out / (c.name + "-" + a.run.setting + ".json"), record_text(c, a.run, result, known));
    }
    const std::string how = verdict(c, a.run, result, known);
    return how == "pass" || how == "known" ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Arguments a = parse(argc, argv);
        if (a.wants_help) {
            std::cout << help;
            return 0;
        }
        if (a.list) {
            for (const Case& c : all_cases()) {
                std::cout << c.name << '\t' << (c.varied ? "varied" : "once") << '\t' << c.trouble << '\n';
            }
            return 0;
        }
        return run_case(a);
    } catch (const RunError& error) {
        std::cerr << "stability: " << error.what() << '\n';
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        std::cerr << "stability: " << error.what() << '\n';
        return static_cast<int>(ExitCode::unexpected);
    }
}
