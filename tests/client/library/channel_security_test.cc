#include "client/library/channel_security.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "client/library/connection_hint.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kSecret[] = "hunter2hunter2";
constexpr char kPem[] = "-----BEGIN CERTIFICATE-----\n";
constexpr char kKeyPem[] = "-----BEGIN PRIVATE KEY-----\n";

TEST(ChannelSecurity, ATokenIsNotSentWithoutTls) {
  for (const char* address : {"localhost:1", "127.0.0.1:1", "example.org:1"}) {
    const absl::Status status = CheckSecurity({.token = kSecret}, address);
    EXPECT_TRUE(absl::IsInvalidArgument(status));
    EXPECT_THAT(std::string(status.message()), HasSubstr("others can read"));
    EXPECT_THAT(std::string(status.message()), Not(HasSubstr(kSecret)));
    EXPECT_FALSE(CheckSecurity({.token_file = "f"}, address).ok());
    EXPECT_TRUE(CheckSecurity({.tls = true, .token = kSecret}, address).ok());
    EXPECT_TRUE(CheckSecurity({.ca = "f", .token_file = "f"}, address).ok());
    EXPECT_TRUE(CheckSecurity({}, address).ok());
  }
}

TEST(ChannelSecurity, ASocketHasNone) {
  EXPECT_TRUE(CheckSecurity({}, "unix:x").ok());
  EXPECT_FALSE(CheckSecurity({.tls = true}, "unix:x").ok());
  EXPECT_FALSE(CheckSecurity({.token_file = "f"}, "unix:x").ok());
}

TEST(ChannelSecurity, ACertificateNeedsItsKey) {
  EXPECT_FALSE(CheckSecurity({.certificate = "f"}, "a:1").ok());
  EXPECT_FALSE(CheckSecurity({.key = "f"}, "a:1").ok());
  EXPECT_TRUE(CheckSecurity({.certificate = "f", .key = "f"}, "a:1").ok());
}

class SecurityFiles : public ::testing::Test {
 protected:
  SecurityFiles() {
    std::string pattern = (std::filesystem::temp_directory_path() / "channel_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~SecurityFiles() override { std::filesystem::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& text, mode_t mode = 0600) {
    const std::string path = folder_ + "/" + name;
    std::ofstream(path) << text;
    chmod(path.c_str(), mode);
    return path;
  }
  absl::Status StatusOf(const ChannelSecurity& security) {
    const absl::Status status = CredentialsOf(security).status();
    EXPECT_THAT(std::string(status.message()), Not(HasSubstr(kSecret)));
    return status;
  }
  absl::Status WithToken(const std::string& text, mode_t mode = 0600) {
    return StatusOf({.tls = true, .token_file = Write("token", text, mode)});
  }

  std::string folder_;
};

TEST_F(SecurityFiles, ATokenFileIsOneWord) {
  EXPECT_TRUE(WithToken(kSecret).ok());
  EXPECT_TRUE(WithToken(std::string(kSecret) + "\r\n").ok());
  for (const std::string& text :
       {std::string(), std::string("\n"), std::string("two ") + kSecret,
        std::string(kSecret) + "\nnext", std::string(kSecret) + "\x01", std::string(257, 'x')}) {
    EXPECT_TRUE(absl::IsInvalidArgument(WithToken(text))) << text;
  }
}

TEST_F(SecurityFiles, ATokenFileThatOthersMayReadIsRefused) {
  for (const mode_t mode : {0640, 0604, 0644, 0660, 0666}) {
    const absl::Status status = WithToken(kSecret, mode);
    EXPECT_TRUE(absl::IsPermissionDenied(status));
    EXPECT_THAT(std::string(status.message()), HasSubstr("chmod 600"));
  }
}

TEST_F(SecurityFiles, AKeyFileThatOthersMayReadIsRefused) {
  ChannelSecurity security;
  security.certificate = Write("cert", kPem, 0644);
  security.key = Write("key", std::string(kKeyPem) + kSecret);
  EXPECT_TRUE(StatusOf(security).ok());
  security.key = Write("key", std::string(kKeyPem) + kSecret, 0644);
  EXPECT_TRUE(absl::IsPermissionDenied(StatusOf(security)));
}

TEST_F(SecurityFiles, WhatCannotBeReadOrIsNoPemIsNamed) {
  ChannelSecurity missing{.ca = folder_ + "/none"};
  EXPECT_THAT(std::string(StatusOf(missing).message()), HasSubstr("none cannot be opened"));
  ChannelSecurity folder{.ca = folder_};
  EXPECT_THAT(std::string(StatusOf(folder).message()), HasSubstr("cannot be read"));
  ChannelSecurity wrong{.ca = Write("ca", kSecret)};
  EXPECT_THAT(std::string(StatusOf(wrong).message()), HasSubstr("PEM is wanted"));
}

TEST(ConnectionHint, SaysWhatToTry) {
  const ChannelSecurity plain, with_ca{.ca = "ca.pem"}, with_tls{.tls = true};
  const ChannelSecurity with_certificate{.tls = true, .certificate = "c.pem", .key = "k"};
  const struct {
    const ChannelSecurity& security;
    const char* message;
    const char* hint;
  } cases[] = {
      {plain, "last error: UNAVAILABLE: ipv4:127.0.0.1:1: Socket closed", "--ca FILE, or --tls"},
      {plain, "recvmsg:Connection reset by peer", "--ca FILE, or --tls"},
      {with_ca, "SSL routines::certificate verify failed", "in ca.pem"},
      {with_tls, "SSL routines::certificate verify failed", "that this system knows"},
      {with_ca, "Peer name x is not in peer certificate", "another host"},
      {with_ca, "SSL routines::wrong version number", "does not speak TLS"},
      {with_ca, "Socket closed", "--cert FILE --key FILE"},
      {with_certificate, "Socket closed", "may not take the certificate in c.pem"}};
  for (const auto& [security, message, hint] : cases) {
    EXPECT_THAT(ConnectionHint(security, message), HasSubstr(hint)) << message;
  }
  EXPECT_EQ(ConnectionHint(plain, "Connection refused"), "");
  EXPECT_EQ(ConnectionHint(with_tls, "Connection refused"), "");
}

}  // namespace
}  // namespace ballpiston::client
