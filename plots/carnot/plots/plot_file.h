// A picture as gnuplot commands, and the file it becomes.
//
// All positions are in hundredths of an inch on a canvas with the origin at the lower left, so that
// the same commands give the same page as .png, .svg, .pdf and .gif.
#pragma once

#include <string>

namespace carnot::plots {

struct Picture {
  double width = 900;
  double height = 600;
  std::string commands;
  bool animated = false;  // a .gif whose frames are the plots of `commands`
  double frame_seconds = 0.06;
};

// Throws std::invalid_argument unless `file` ends in .png, .svg, .pdf or .gif and its directory can
// be written. Call it before any work.
void validate_plot_file(const std::string& file);

[[nodiscard]] bool is_gif(const std::string& file);

// Draws the picture with gnuplot. The file appears whole or not at all: gnuplot draws inside a
// temporary directory beside it, and a rename ends the work. Prints nothing and returns
// gnuplot's warnings, usually none. Throws std::invalid_argument as above, and std::runtime_error
// with gnuplot's message when it fails.
std::string write_picture(const std::string& file, const Picture& picture);

}  // namespace carnot::plots
