# The command from the release's archives, for a Homebrew tap.
class Taotie < Formula
  desc "@SHORT SUMMARY@"
  homepage "@REPOSITORY@"
  version "@VERSION@"
  license any_of: ["MIT", "Apache-2.0"]

  on_macos do
    on_arm do
      url "@DOWNLOADS@/@ARCHIVE aarch64-apple-darwin@"
      sha256 "@SHA256 aarch64-apple-darwin@"
    end
    on_intel do
      url "@DOWNLOADS@/@ARCHIVE x86_64-apple-darwin@"
      sha256 "@SHA256 x86_64-apple-darwin@"
    end
  end

  on_linux do
    on_arm do
      url "@DOWNLOADS@/@ARCHIVE aarch64-unknown-linux-musl@"
      sha256 "@SHA256 aarch64-unknown-linux-musl@"
    end
    on_intel do
      url "@DOWNLOADS@/@ARCHIVE x86_64-unknown-linux-musl@"
      sha256 "@SHA256 x86_64-unknown-linux-musl@"
    end
  end

  def install
    bin.install "taotie"
    man1.install Dir["man/*.1"]
    bash_completion.install "completions/bash/taotie"
    fish_completion.install "completions/fish/taotie.fish"
    zsh_completion.install "completions/zsh/_taotie"
  end

  test do
    (testpath/"scan.obj").write <<~OBJ
      v 0 0 0
      v 1 0 0
      v 0 1 0
      v 0 0 1
      f 1 3 2
      f 1 2 4
      f 2 3 4
      f 1 4 3
    OBJ
    assert_match version.to_s, shell_output("#{bin}/taotie --version")
    system bin/"taotie", "bake", "scan.obj", "-o", "asset.glb", "--flat"
    assert_path_exists testpath/"asset.report.html"
  end
end
