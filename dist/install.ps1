# Installs the command `taotie` on Windows: downloads the release, checks its SHA-256, and unpacks program and completions.
#
#   irm https://github.com/OWNER/taotie/releases/latest/download/install.ps1 | iex
#
# Environment:
#   TAOTIE_VERSION      the release, such as 0.1.0 (default: the latest)
#   TAOTIE_INSTALL_DIR  the folder of the program (default: ~\.local\bin); completions go to ..\share if it is called `bin`
#   TAOTIE_DOWNLOADS    the address of a folder with SHA256SUMS and archives (default: that of the release)

& {
    Set-StrictMode -Version 3.0
    $ErrorActionPreference = 'Stop'
    # Progress bars make Windows PowerShell download many times slower.
    $ProgressPreference = 'SilentlyContinue'

    $repository = 'https://github.com/OWNER/taotie'
    # Windows on ARM64 runs programs for x86-64.
    $target = 'x86_64-pc-windows-gnu'

    # Returns the SHA-256 and the name of the archive for the target, from a list.
    function Get-Listed($list) {
        foreach ($line in Get-Content -LiteralPath $list) {
            $sum, $name = $line -split '\s+\*?', 2
            if ($name -like "taotie-*-$target.zip") { return $sum, $name }
        }
        throw "install.ps1: the release has no archive for $target"
    }

    # Prints how to add a folder to the user's search path, unless it is there.
    function Show-Path($folder) {
        if (($env:PATH -split ';') -contains $folder) { return }
        Write-Host "To run it by name, add its folder to your search path:"
        Write-Host "  [Environment]::SetEnvironmentVariable('PATH', [Environment]::GetEnvironmentVariable('PATH', 'User') + ';$folder', 'User')"
    }

    # Windows PowerShell before 5.1.17763 offers only older versions of TLS.
    [Net.ServicePointManager]::SecurityProtocol = [Net.ServicePointManager]::SecurityProtocol -bor [Net.SecurityProtocolType]::Tls12
    $folder = if ($env:TAOTIE_INSTALL_DIR) { $env:TAOTIE_INSTALL_DIR } else { Join-Path $HOME '.local\bin' }
    $downloads = if ($env:TAOTIE_DOWNLOADS) { $env:TAOTIE_DOWNLOADS.TrimEnd('/') }
        elseif ($env:TAOTIE_VERSION) { "$repository/releases/download/v$($env:TAOTIE_VERSION -replace '^v', '')" }
        else { "$repository/releases/latest/download" }

    $place = Join-Path ([IO.Path]::GetTempPath()) "taotie-$([Guid]::NewGuid())"
    New-Item -ItemType Directory -Path $place | Out-Null
    try {
        $list = Join-Path $place 'SHA256SUMS'
        Invoke-WebRequest -UseBasicParsing -Uri "$downloads/SHA256SUMS" -OutFile $list
        $listed, $archive = Get-Listed $list
        $file = Join-Path $place $archive
        Write-Host "downloading $downloads/$archive"
        Invoke-WebRequest -UseBasicParsing -Uri "$downloads/$archive" -OutFile $file
        $actual = (Get-FileHash -Algorithm SHA256 -LiteralPath $file).Hash
        if ($actual -ne $listed) {
            throw "install.ps1: $archive has SHA-256 $actual, but the release lists ${listed}: nothing was installed; try again later"
        }
        Expand-Archive -LiteralPath $file -DestinationPath $place

        $unpacked = Join-Path $place ([IO.Path]::GetFileNameWithoutExtension($archive))
        New-Item -ItemType Directory -Force -Path $folder | Out-Null
        $program = Join-Path $folder 'taotie.exe'
        Copy-Item -Force -LiteralPath (Join-Path $unpacked 'taotie.exe') -Destination $program
        $version = & $program --version
        if ($LASTEXITCODE -ne 0) { throw "install.ps1: $program does not run on this machine: build from source, $repository" }
        Write-Host "installed $version in $folder"
        if ((Split-Path -Leaf $folder) -eq 'bin') {
            $completions = Join-Path (Split-Path -Parent $folder) 'share\powershell'
            New-Item -ItemType Directory -Force -Path $completions | Out-Null
            $script = Join-Path $completions '_taotie.ps1'
            Copy-Item -Force -LiteralPath (Join-Path $unpacked 'completions\powershell\_taotie.ps1') -Destination $script
            Write-Host "For completions, add to `$PROFILE:  . '$script'"
        }
        Show-Path $folder
    }
    finally {
        Remove-Item -Recurse -Force -LiteralPath $place
    }
}
