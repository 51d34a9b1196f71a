#include "client/library/request_id.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

TEST(RequestId, IsARandomUuid) {
  constexpr char kUuid[] = "[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}";
  std::set<std::string> ids;
  for (int i = 0; i < 1000; ++i) {
    ids.insert(NewRequestId());
    EXPECT_THAT(NewRequestId(), MatchesRegex(kUuid));
  }
  EXPECT_EQ(ids.size(), 1000u);
}

// A later version of the program must make the same ids.
TEST(RequestId, OfATextIsStable) {
  EXPECT_EQ(RequestIdFor(""), "cbf29ce4-8422-8325-9e37-79b97f4a7c15");
  EXPECT_EQ(RequestIdFor("question 0"), "f158c797-54ff-80dd-b8d7-5edcd5c77fad");
}

TEST(RequestId, DiffersBetweenTexts) {
  constexpr char kUuid[] = "[0-9a-f]{8}-[0-9a-f]{4}-8[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}";
  std::set<std::string> ids;
  for (int i = 0; i < 1000; ++i) {
    ids.insert(RequestIdFor("question " + std::to_string(i)));
    EXPECT_THAT(*ids.rbegin(), MatchesRegex(kUuid));
  }
  EXPECT_EQ(ids.size(), 1000u);
}

TEST(RequestId, HasTheFormOfAUuid) {
  const std::string id = "123e4567-e89b-12d3-a456-426614174000";
  EXPECT_TRUE(IsRequestId(id));
  EXPECT_TRUE(IsRequestId("123E4567-E89B-12D3-A456-426614174000"));
  for (const std::string& text : {std::string(), id + "0", id.substr(1), "x" + id.substr(1),
                                  "-" + id.substr(1), std::string(36, '0')}) {
    EXPECT_FALSE(IsRequestId(text)) << text;
  }
}

}  // namespace
}  // namespace ballpiston::client
