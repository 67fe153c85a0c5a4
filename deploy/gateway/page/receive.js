// The viewer's data come from the page around it.
"use strict";

document.getElementById("data").textContent = JSON.stringify(parent.latvox.data);
