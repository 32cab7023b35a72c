#include "carnot/plots/plot_file.h"

#include <gnuplot-iostream.h>
#include <unistd.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "carnot/plots/replace_file.h"
#include "carnot/plots/run_gnuplot.h"

namespace carnot::plots {
namespace {

namespace fs = std::filesystem;

// The ending in small letters, with its dot.
std::string ending(const std::string& file) {
  std::string text = fs::path(file).extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

fs::path directory_of(const std::string& file) {
  const fs::path parent = fs::path(file).parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

// The same page for every ending: sizes in the unit each terminal wants, fonts to match.
std::string terminal(const std::string& ending, const Picture& picture) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  const auto pixels = [&](double scale) {
    std::ostringstream size;
    size.imbue(std::locale::classic());
    size << " size " << std::lround(scale * picture.width) << ","
         << std::lround(scale * picture.height);
    return size.str();
  };
  out << "set terminal ";
  if (ending == ".png") {
    out << "pngcairo enhanced font 'Sans,11' fontscale 2 linewidth 2 pointscale 2" << pixels(2);
  } else if (ending == ".svg") {
    out << "svg enhanced font 'Sans,14' background '#ffffff'" << pixels(1);
  } else if (ending == ".pdf") {
    out << "pdfcairo enhanced font 'Sans,11' fontscale 0.72 linewidth 1.4 pointscale 1.4 size "
        << picture.width / 100 << "in," << picture.height / 100 << "in";
  } else {
    out << "gif enhanced font 'Sans,11' background '#ffffff'" << pixels(1);
    if (picture.animated) {
      out << " animate delay " << std::lround(100 * picture.frame_seconds) << " loop 0";
    }
  }
  out << "\n";
  return out.str();
}

// A directory beside the target, removed with all it holds.
class Workshop {
 public:
  explicit Workshop(const fs::path& parent) {
    std::string name = (parent / ".carnot-plot-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("cannot write in directory '" + parent.string() + "'");
    }
    path_ = name;
  }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  ~Workshop() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] std::string read(const char* name) const {
    std::ifstream in(path_ / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }

 private:
  fs::path path_;
};

// What gnuplot said, but for the count of frames it gives for every film.
std::string first_lines(const std::string& text) {
  constexpr std::size_t kLongest = 600;
  std::istringstream in(text);
  std::string kept;
  for (std::string line; std::getline(in, line) && kept.size() < kLongest;) {
    const bool blank = line.find_first_not_of(" \t") == std::string::npos;
    if (blank || line.find("frames in animation") != std::string::npos) continue;
    kept += (kept.empty() ? "" : "\n") + line;
  }
  return kept.substr(0, kLongest);
}

}  // namespace

bool is_gif(const std::string& file) { return ending(file) == ".gif"; }

void validate_plot_file(const std::string& file) {
  const std::string end = ending(file);
  if (end != ".png" && end != ".svg" && end != ".pdf" && end != ".gif") {
    throw std::invalid_argument("plot file '" + file + "' must end in .png, .svg, .pdf or .gif");
  }
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    throw std::invalid_argument("plot file '" + file + "' is a directory");
  }
  const fs::path parent = directory_of(file);
  if (!fs::is_directory(parent, ignored)) {
    throw std::invalid_argument("plot file '" + file + "' must lie in a directory that exists");
  }
  if (access(parent.c_str(), W_OK | X_OK) != 0) {
    throw std::invalid_argument("plot file '" + file + "' must lie in a writable directory");
  }
}

std::string write_picture(const std::string& file, const Picture& picture) {
  validate_plot_file(file);
  const Workshop workshop(fs::absolute(directory_of(followed(file))));
  const std::string name = "figure" + ending(file);
  {
    gnuplotio::Gnuplot script(">" + (workshop.path() / "script").string());
    script << "set encoding utf8\nset minussign\n" << terminal(ending(file), picture);
    script << "set output '" << name << "'\n" << picture.commands << "\nset output\n";
    if (!script.flush()) {
      throw std::runtime_error("cannot write '" + file + "': no room for gnuplot's script");
    }
  }
  const auto failed = [&](const std::string& why) {
    return std::runtime_error("gnuplot could not draw '" + file + "': " + why);
  };
  bool ended_well = false;
  try {
    ended_well = run_gnuplot(workshop.path().string(), "script", "log");
  } catch (const std::runtime_error& error) {
    throw failed(error.what());
  }
  const fs::path drawn = workshop.path() / name;
  std::error_code error;
  const auto size = fs::file_size(drawn, error);
  if (!ended_well || error || size == 0) throw failed(first_lines(workshop.read("log")));
  replace_file(drawn.string(), file);
  return first_lines(workshop.read("log"));
}

}  // namespace carnot::plots
