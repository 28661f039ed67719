"""Workers between the document and the views: answers in, pictures out, the newest wish first."""
