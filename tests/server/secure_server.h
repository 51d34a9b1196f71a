// A server behind TLS in this process, with the credentials of a small laboratory: alice, who
// submits jobs and has a second token that may only read; bob, who submits too; ops, who may all.
#ifndef BALLPISTON_TESTS_SERVER_SECURE_SERVER_H_
#define BALLPISTON_TESTS_SERVER_SECURE_SERVER_H_

#include <memory>
#include <string>

#include "grpcpp/channel.h"
#include "server/ballpiston_server.h"
#include "tests/credentials/test_authority.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {

inline constexpr char kAlice[] = "token-of-alice-0123456789";
inline constexpr char kAliceReads[] = "token-of-alice-that-reads";
inline constexpr char kAliceOnce[] = "token-of-alice-that-expired";
inline constexpr char kBob[] = "token-of-bob-0123456789";
inline constexpr char kOps[] = "token-of-ops-0123456789";

// A folder with an access file of these tokens, and certificates of an authority of its own.
class LaboratoryFiles {
 public:
  explicit LaboratoryFiles(bool mutual = false);

  const SecurityOptions& options() const { return options_; }
  const TestAuthority& authority() const { return authority_; }
  std::string Path(const std::string& name) const { return folder_.File(name); }

  // A file of mode 0600.
  std::string Write(const std::string& name, const std::string& text) const;
  void WriteAccessFile(const std::string& text) const { Write("access", text); }
  void WriteCertificate(const KeyAndCertificate& made) const;

 private:
  TemporaryFolder folder_;
  TestAuthority authority_{"the laboratory's authority"};
  SecurityOptions options_;
};

// The lines of all five tokens.
std::string LaboratoryTokens();

// At any free port of this machine, with fake experiments.
ServerOptions SecureOptions(const SecurityOptions& security, const std::string& data_dir);

// TLS to a server whose authority is `ca` (PEM); a connection of its own. `own` is the client's
// certificate, if it has one.
std::shared_ptr<grpc::Channel> SecureChannel(const std::string& address, const std::string& ca,
                                             const KeyAndCertificate& own = {});

// The common name in the certificate that the server shows a new client now; empty if none.
std::string ServedCommonName(const std::string& address);

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_SERVER_SECURE_SERVER_H_
