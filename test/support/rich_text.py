# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Texts that Qt would take for HTML."""
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QTextDocument
from python_qt_binding.QtWidgets import QComboBox, QLabel, QTextEdit

from mhri.base.gui.labels import plain_tip

# What stands for an image in the text of a document.
IMAGE = '\ufffc'


def renders(text):
    """Return whether Qt would make more than plain text of a tool tip."""
    if not Qt.mightBeRichText(text):
        return False
    document = QTextDocument()
    document.setHtml(text)
    return plain_tip(document.toPlainText()) != text


def takes_for_html(widget):
    """Return what of a widget would be taken for HTML."""
    tips = [widget.toolTip(), widget.statusTip(), widget.whatsThis()]
    if isinstance(widget, QComboBox):
        tips += [str(widget.itemData(row, role) or '') for row in range(widget.count())
                 for role in (Qt.ToolTipRole, Qt.StatusTipRole, Qt.WhatsThisRole)]
    found = [tip for tip in tips if renders(tip)]
    if isinstance(widget, QLabel) and widget.textFormat() != Qt.PlainText \
            and Qt.mightBeRichText(widget.text()):
        found.append(widget.text())
    if isinstance(widget, QTextEdit) and IMAGE in widget.toPlainText():
        found.append(widget.toHtml())
    return found
