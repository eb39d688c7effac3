#include "plot.hpp"

#include <cstdlib>
#include <filesystem>

#include "io/format/atomic_file.hpp"
#include "io/measurements/signal_delay.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "report/plot.hpp"

namespace posewise::cli {
namespace {

namespace fs = std::filesystem;

/// A folder of its own among the temporary ones, gone with all it holds at the end.
class ScratchFolder {
  public:
    ScratchFolder() {
        std::error_code error;
        std::string pattern = (fs::temp_directory_path(error) / "posewise.XXXXXX").string();
        if (error || ::mkdtemp(pattern.data()) == nullptr) {
            throw InputError("no temporary folder can be made; TMPDIR must name one");
        }
        path_ = pattern;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    std::string path_of(const std::string& name) const { return (path_ / name).string(); }

  private:
    fs::path path_;
};

/// A path as a shell takes it for one argument, whatever is in it.
std::string quote_for_shell(const std::string& path) {
    std::string quoted = "'";
    for (const char c : path.starts_with('/') ? path : "./" + path) {
        quoted += c == '\'' ? "'\\''" : std::string(1, c);
    }
    return quoted + "'";
}

/// Leaves the script for the user, unless a file has its name already. What to do with it.
std::string leave_script(const std::string& script, const std::string& image_path) {
    const std::string path = image_path + ".gnuplot";
    if (fs::exists(fs::symlink_status(path))) return "";
    detail::write_file(path, script);
    return "; its script is left, try: gnuplot " + quote_for_shell(path);
}

}  // namespace

void add_plot_option(CLI::App& command, std::string& path, const std::string& what) {
    command.add_option("--plot", path, what + ": .svg or .png")->check(file_name());
}

void draw_plot(const std::string& image_path, const MakeScript& make_script) {
    const detail::SignalDelay delay;
    const ScratchFolder folder;
    const std::string image = folder.path_of("image" + fs::path(image_path).extension().string());
    const std::string script = folder.path_of("script.gnuplot");
    detail::write_file(script, make_script(image));
    try {
        detail::run_gnuplot(script, detail::SignalDelay::has_come);
        if (!fs::exists(image)) throw InputError("gnuplot wrote no image");
    } catch (const InputError& error) {
        if (detail::SignalDelay::has_come()) return;  // it ends the program
        throw input_error_at({image_path}, std::string("the plot was not drawn, ") + error.what() +
                                               leave_script(make_script(image_path), image_path));
    }
    detail::write_file(image_path, detail::read_file(image));
}

}  // namespace posewise::cli
