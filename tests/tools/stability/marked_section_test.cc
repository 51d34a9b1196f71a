#include "tools/stability/marked_section.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::stability {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kPage[] =
    "before\n<!-- table:begin -->\nold\n<!-- table:end -->\n"
    "after\n<!-- other:begin -->\nother\n<!-- other:end -->\n";

class MarkedSection : public ::testing::Test {
 protected:
  // Checks and then replaces the section `table` of a page. Expects the same error from both
  // functions, and returns it.
  std::string ErrorWith(const std::string& page) const {
    WriteFile(path_, page);
    const absl::Status checked = CheckMarkedSection(path_, "table");
    EXPECT_EQ(Contents(path_), page);
    EXPECT_EQ(ReplaceMarkedSection(path_, "table", "new\n"), checked);
    return checked.ok() ? "" : checked.ToString();
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.File("page.md");
};

TEST_F(MarkedSection, OnlyTheTextBetweenTheMarkersIsReplaced) {
  EXPECT_EQ(ErrorWith(kPage), "");
  EXPECT_EQ(Contents(path_),
            "before\n<!-- table:begin -->\nnew\n<!-- table:end -->\n"
            "after\n<!-- other:begin -->\nother\n<!-- other:end -->\n");
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("page.md"));
}

TEST_F(MarkedSection, APageWithoutBothMarkersInOrderStaysAsItIs) {
  for (const std::string page :
       {"no section\n", "<!-- table:begin -->\nold\n", "old\n<!-- table:end -->\n",
        "<!-- table:end -->\nold\n<!-- table:begin -->\n"}) {
    EXPECT_THAT(ErrorWith(page),
                HasSubstr(path_ + " lacks the lines <!-- table:begin --> and <!-- table:end -->"))
        << page;
    EXPECT_EQ(Contents(path_), page);
  }
}

TEST_F(MarkedSection, APageThatCannotBeReadIsNamed) {
  for (const std::string& path : {folder_.File("missing.md"), folder_.path()}) {
    EXPECT_EQ(CheckMarkedSection(path, "table").message(), "cannot read " + path);
    EXPECT_EQ(ReplaceMarkedSection(path, "table", "new\n").message(), "cannot read " + path);
  }
}

}  // namespace
}  // namespace ballpiston::stability
