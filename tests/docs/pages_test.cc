// README.md and docs/*.md are true: their commands are run and what they print is compared, the
// code that they quote is that of files which are compiled, and their links lead somewhere.
//
// The commands of a page run by sh in one empty directory, with the built program as `carnot` and
// as scripts/run.sh, the programs of docs/examples as ./coin and so on, and the scenes beside them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "docs/page.h"
#include "docs/printed.h"

namespace carnot::docs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

const fs::path kProject = CARNOT_SOURCE_DIR;

std::vector<fs::path> files_in(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> list;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ending) list.push_back(entry.path());
  }
  std::sort(list.begin(), list.end());
  return list;
}

std::vector<fs::path> pages() {
  std::vector<fs::path> list = files_in(kProject / "docs", ".md");
  list.push_back(kProject / "README.md");
  list.push_back(kProject / "CONTRIBUTING.md");
  return list;
}

// An empty directory to run the commands in, removed at the end.
class Workplace {
 public:
  Workplace() {
    std::string name = (fs::temp_directory_path() / "carnot-XXXXXX").string();
    root_ = mkdtemp(name.data());
    fs::create_directories(root_ / "bin");
    fs::create_directories(root_ / "work" / "scripts");
    fs::create_symlink(CARNOT_PROGRAM, root_ / "bin" / "carnot");
    fs::create_symlink(CARNOT_PROGRAM, root_ / "work" / "scripts" / "run.sh");
    for (const auto& entry : fs::directory_iterator(EXAMPLES_DIR)) {
      fs::create_symlink(entry.path(), root_ / "work" / entry.path().filename());
    }
    for (const fs::path& scene : files_in(kProject / "docs" / "examples" / "scenes", ".scene")) {
      fs::create_symlink(scene, root_ / "work" / scene.filename());
    }
  }
  ~Workplace() {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  [[nodiscard]] std::string output_of(const std::string& command) const {
    std::ofstream(root_ / "command") << command << '\n';
    const std::string root = root_.string();
    const std::string line =
        "cd '" + root + "/work' && PATH='" + root +
        "/bin':\"$PATH\" LC_ALL=C.UTF-8 sh ../command > ../out 2>&1 < /dev/null";
    const int status = std::system(line.c_str());
    return read_text(root + "/out") + (status == 0 ? "" : "(the command failed)\n");
  }

 private:
  fs::path root_;
};

class PagesTest : public testing::TestWithParam<fs::path> {
 protected:
  [[nodiscard]] std::string text() const { return read_text(GetParam()); }
};

TEST_P(PagesTest, CommandsPrintWhatItSays) {
  const Workplace workplace;
  for (const auto& [command, output] : transcripts(text())) {
    const std::string actual = workplace.output_of(command);
    EXPECT_TRUE(agrees(output, actual)) << "$ " << command << "\nThe page says\n"
                                        << output << "\nand it prints\n"
                                        << actual;
  }
}

TEST_P(PagesTest, CodeIsThatOfTheFile) {
  for (const auto& [file, whole, quoted] : quotations(text())) {
    ASSERT_FALSE(file.empty()) << "no line <!-- FILE --> before\n" << quoted;
    const std::string code = read_text(kProject / file);
    if (whole) {
      EXPECT_EQ(quoted, code) << file;
    } else {
      EXPECT_NE(('\n' + code).find('\n' + quoted), std::string::npos)
          << file << " has no such lines:\n"
          << quoted;
    }
  }
}

TEST_P(PagesTest, LinksLeadSomewhere) {
  for (const std::string& link : links(text())) {
    const std::size_t sharp = link.find('#');
    const std::string file = link.substr(0, sharp);
    const fs::path path = file.empty() ? GetParam() : GetParam().parent_path() / file;
    EXPECT_TRUE(fs::exists(path)) << link;
    if (sharp == std::string::npos) continue;
    EXPECT_THAT(anchors(read_text(path)), Contains(link.substr(sharp + 1))) << link;
  }
}

// A tag such as [MMVW13] is that of an entry of docs/references.md.
TEST_P(PagesTest, TagsAreInTheReferences) {
  static const std::regex kTag(R"(\[([A-Z][A-Za-z]*[0-9]{2}[a-z]?)\])");
  const std::string page = prose(text());
  const std::string references = read_text(kProject / "docs" / "references.md");
  for (std::sregex_iterator i(page.begin(), page.end(), kTag), end; i != end; ++i) {
    EXPECT_NE(references.find("**" + i->str() + "**"), std::string::npos) << i->str();
  }
}

INSTANTIATE_TEST_SUITE_P(Docs, PagesTest, testing::ValuesIn(pages()), [](const auto& page) {
  return page.param.stem().string();
});

TEST(Readme, LeadsToEveryPage) {
  const auto list = links(read_text(kProject / "README.md"));
  for (const fs::path& page : files_in(kProject / "docs", ".md")) {
    EXPECT_THAT(list, Contains("docs/" + page.filename().string()));
  }
}

TEST(Examples, AreQuotedAndRun) {
  std::set<std::string> quoted;
  std::set<std::string> run;
  for (const fs::path& page : pages()) {
    const std::string text = read_text(page);
    for (const Quotation& quotation : quotations(text)) quoted.insert(quotation.file);
    for (const Transcript& transcript : transcripts(text)) run.insert(transcript.command);
  }
  const auto examples = files_in(kProject / "docs" / "examples", ".cc");
  EXPECT_THAT(examples, SizeIs(testing::Ge(8)));
  for (const fs::path& example : examples) {
    EXPECT_THAT(quoted, Contains("docs/examples/" + example.filename().string()));
    EXPECT_THAT(run, Contains("./" + example.stem().string()));
  }
}

TEST(Page, FindsTheCommands) {
  const auto list = transcripts("$ no\n```console\n$ one\n1\n\n2\n$ two\n```\n```sh\n$ no\n```\n");
  ASSERT_THAT(list, SizeIs(2));
  EXPECT_EQ(list[0].command, "one");
  EXPECT_EQ(list[0].output, "1\n\n2\n");
  EXPECT_EQ(list[1].command, "two");
  EXPECT_EQ(list[1].output, "");
}

TEST(Page, FindsTheQuotations) {
  const auto list = quotations(
      "<!-- a.cc -->\n```cpp\none\n```\n<!-- from b.cc "
      "-->\n```cpp\ntwo\n```\n```cpp\nthree\n```\n");
  ASSERT_THAT(list, SizeIs(3));
  EXPECT_EQ(list[0].file, "a.cc");
  EXPECT_TRUE(list[0].whole);
  EXPECT_EQ(list[0].text, "one\n");
  EXPECT_EQ(list[1].file, "b.cc");
  EXPECT_FALSE(list[1].whole);
  EXPECT_EQ(list[2].file, "");
}

TEST(Page, FindsTheLinksAndSections) {
  EXPECT_THAT(links("[a](b.md#c), ![d](e.png), [f](https://g.org)\n```cpp\n[](int x)\n```\n"),
              ElementsAre("b.md#c", "e.png"));
  EXPECT_THAT(anchors("# One\n\ntext\n## What it is, in `two` words\n#no\n"),
              ElementsAre("one", "what-it-is-in-two-words"));
  EXPECT_THAT(anchors("none"), IsEmpty());
}

}  // namespace
}  // namespace carnot::docs
