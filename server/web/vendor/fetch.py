"""Puts the files that vendor.json lists here, out of their npm packages.

    python3 server/web/vendor/fetch.py            fetches them, and refuses other bytes than the recorded ones
    python3 server/web/vendor/fetch.py --record   records the hashes of what it fetched, after a version was changed

npm has to be installed; it takes the packages from whichever registry it is set up for.
"""

import hashlib
import json
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

FOLDER = Path(__file__).parent
LIST = FOLDER / "vendor.json"


def main() -> None:
    """Fetches all packages."""
    packages = json.loads(LIST.read_text())
    for package in packages:
        archive_of(package)
    if "--record" in sys.argv[1:]:
        LIST.write_text(json.dumps(packages, indent=2) + "\n")


def archive_of(package: dict) -> None:
    """Fetches one package and writes its files."""
    name = f"{package['package']}@{package['version']}"
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["npm", "pack", "--silent", name], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        (archive,) = Path(folder).glob("*.tgz")
        with tarfile.open(archive) as files:
            for target, file in package["files"].items():
                member = files.extractfile(f"package/{file['from']}")
                if member is None:
                    sys.exit(f"{name} has no file {file['from']}")
                content = member.read()
                found = hashlib.sha256(content).hexdigest()
                if "--record" in sys.argv[1:]:
                    file["sha256"] = found
                elif found != file["sha256"]:
                    sys.exit(f"{name}: {target} has the hash {found}, not {file['sha256']}")
                (FOLDER / target).write_bytes(content)


if __name__ == "__main__":
    main()
