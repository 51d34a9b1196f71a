#include "client/web/page_files.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

std::map<std::string, PageFile> Files() {
  return {{"page.html",
           {"text/html",
            "<head><link rel=\"stylesheet\" href=\"a.css\">\n"
            "<link rel=\"stylesheet\" href=\"b.css\"></head>"
            "<body><!-- data --><script src=\"c.js\" defer></script></body>"}},
          {"a.css", {"text/css", "a{}\n"}},
          {"b.css", {"text/css", "b{}\n"}},
          {"c.js", {"text/javascript", "c();\n"}}};
}

TEST(OneFilePage, HasItsFilesInTheirPlaces) {
  EXPECT_EQ(*OneFilePage(Files(), "page.html", "{}"),
            "<head><style>\na{}\n</style>\n<style>\nb{}\n</style></head>"
            "<body><script type=\"application/json\" id=\"data\">{}</script>"
            "<script>\nc();\n</script></body>");
}

TEST(OneFilePage, DataStaysInsideItsScript) {
  const std::string page = *OneFilePage(Files(), "page.html", R"({"x":"</script><!--<b>"})");
  EXPECT_THAT(page, HasSubstr(R"({"x":"\u003c/script>\u003c!--\u003cb>"})"));
}

TEST(OneFilePage, NamesAMissingFile) {
  auto files = Files();
  files.erase("b.css");
  EXPECT_THAT(OneFilePage(files, "page.html", "{}").status().message(), HasSubstr("b.css"));
  EXPECT_EQ(OneFilePage(files, "no.html", "{}").status().code(),
            absl::StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace ballpiston::client
