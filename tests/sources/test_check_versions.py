"""check_versions.py notices a version that was left behind."""

import pathlib
import tempfile
import unittest

import check_versions


class VersionsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name, text in {
            "CMakeLists.txt": "project(vdwmesh VERSION 1.2.3 LANGUAGES CXX)\n",
            "CITATION.cff": "cff-version: 1.2.0\nversion: 1.2.3\n",
            "CHANGELOG.md": "# Changelog\n\n## 1.2.3 (unreleased)\n\n## 1.2.2 (2020-01-01)\n",
            "apps/build_id.hpp": 'extern const char* const kVersion;  // "1.2.3"\n',
            "tests/consumer/CMakeLists.txt": "find_package(vdwmesh 1.2 REQUIRED)\n",
            "pyproject.toml": 'dynamic = ["version"]\n',
        }.items():
            (self.root / name).parent.mkdir(parents=True, exist_ok=True)
            (self.root / name).write_text(text)

    def test_all_agree(self):
        self.assertEqual(list(check_versions.wrong_versions(self.root)), [])

    def test_one_is_left_behind(self):
        for name in check_versions.PLACES:
            path = self.root / name
            text = path.read_text()
            path.write_text(text.replace("1.2", "1.1"))
            self.assertEqual(len(list(check_versions.wrong_versions(self.root))), 1, name)
            path.write_text("")
            self.assertEqual(len(list(check_versions.wrong_versions(self.root))), 1, name)
            path.write_text(text)

    def test_the_date_of_a_release(self):
        self.assertEqual(len(list(check_versions.not_ready(self.root))), 1)
        path = self.root / "CHANGELOG.md"
        path.write_text(path.read_text().replace("unreleased", "2021-02-03"))
        self.assertEqual(list(check_versions.not_ready(self.root)), [])


if __name__ == "__main__":
    unittest.main()
