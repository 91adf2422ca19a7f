// A browser lets no page that it opened from the disk read the search index: no box that finds nothing.
if (location.protocol === "file:") document.documentElement.classList.add("from-disk")
