# Shared by run and format; source it. Goes to this folder and installs what package-lock.json names.
# shellcheck shell=bash

cd "$(dirname "${BASH_SOURCE[0]}")"

skip() {
  echo "skipped: $1"
  exit 77
}
command -v node > /dev/null || skip "no node"
command -v npm > /dev/null || skip "no npm"
(( $(node --print 'process.versions.node.split(".")[0]') >= 20 )) || skip "node is older than 20"
if ! npm ls --silent > /dev/null 2>&1; then
  npm ci --ignore-scripts --no-audit --no-fund --loglevel=error || skip "npm cannot install what package-lock.json names"
fi
