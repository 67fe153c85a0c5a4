"""pip builds the package from nothing but the sources. The build folder is build/pip, and a first build takes long."""

from page_install import install_and_try


def test_the_page_s_commands_build_the_package(tmp_path):
    install_and_try(tmp_path)
