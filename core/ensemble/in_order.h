// Results that arrive in any order leave in the order of their keys.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>

namespace ballpiston {

template <typename Key, typename Result>
class InOrder {
 public:
  // Keeps a result until its turn. Drops a second one with the same key.
  void Add(const Key& key, Result result) { early_.emplace(key, std::move(result)); }

  // The result with this key, which is the next one to leave; empty if it has not arrived.
  std::optional<Result> Take(const Key& key) {
    if (!early_.contains(key)) return std::nullopt;
    return std::move(early_.extract(key).mapped());
  }

  // Null if there is none.
  const Result* Find(const Key& key) const {
    const auto found = early_.find(key);
    return found == early_.end() ? nullptr : &found->second;
  }

  bool Has(const Key& key) const { return early_.contains(key); }
  size_t size() const { return early_.size(); }
  void Clear() { early_.clear(); }

 private:
  std::map<Key, Result> early_;
};

}  // namespace ballpiston
